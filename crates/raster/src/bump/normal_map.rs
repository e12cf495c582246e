//! Normals as colours, and normal maps over one another.

use glam::Vec3;

/// The tangent-space normal of a texel: `2 c - 1` in each band, of length 1; straight out if that has no length.
///
/// The texel is data, not colour: no transfer function is applied to it.
pub fn decode_normal(texel: [f32; 3]) -> Vec3 {
    (Vec3::from(texel) * 2.0 - 1.0).normalize_or(Vec3::Z)
}

/// The texel of a tangent-space normal: `(n + 1) / 2`.
pub fn encode_normal(normal: Vec3) -> [f32; 3] {
    ((normal + 1.0) * 0.5).to_array()
}

/// A detail normal laid over a base normal: the shortest rotation that takes +Z to `base`, applied to `detail`.
///
/// Reoriented normal mapping (Barre-Brisebois and Hill, *Blending in detail*, 2012): with `t = base + z`,
/// `r = t (t . detail') / t_z - detail'` where `detail' = (-x, -y, z)`. Unlike sums of normals it keeps both strengths, and
/// a flat base or a flat detail leaves the other as it is. For a base that points straight in, `detail` turned over.
pub fn blend_reoriented(base: Vec3, detail: Vec3) -> Vec3 {
    let t = base + Vec3::Z;
    let u = Vec3::new(-detail.x, -detail.y, detail.z);
    // t.z = |t|^2 / 2 for a unit base; near 0 the quotient would be 0/0.
    if t.z < 1e-6 {
        return -u;
    }
    (t * (t.dot(u) / t.z) - u).normalize_or(base)
}
