//! Normals turned by reliefs: normal maps and height maps.

use crate::filtering::sample;
use crate::footprint::Footprint;
use crate::sight::SurfaceHit;
use crate::stage::Stage;
use crate::surface::{mixed, texcoords};
use glam::{Vec2, Vec3, Vec4};
use hemicube_raster::bump::SurfaceGradient;
use hemicube_scene::{Relief, ReliefKind, TextureSlot, TextureUse};

/// A normal under a relief.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bumped {
    /// Unit normal.
    pub normal: Vec3,
    /// Variance of the slopes that one normal stands for, along one direction: what is smaller than the sample.
    pub variance: f32,
}

/// The normal of a relief's texture at a hit whose normal is `normal` on the side that is seen; exactly that where the
/// relief is flat. From behind, bumps are dents.
pub(crate) fn bumped(
    stage: &Stage<'_>,
    hit: &SurfaceHit,
    footprint: &Footprint,
    relief: Relief,
    normal: Vec3,
) -> Bumped {
    let Some(frame) = stage.tangents.of(hit) else {
        return Bumped {
            normal,
            variance: 0.0,
        };
    };
    let in_texture = match relief.kind {
        ReliefKind::Normal { scale } => normal_of_texel(stage, hit, footprint, relief.slot, scale),
        ReliefKind::Height { depth } => {
            normal_of_heights(stage, hit, footprint, relief.slot, depth)
        }
    };
    let front = if frame.is_turned { -normal } else { normal };
    let tangent = mixed(frame.corners, hit.weights);
    let along = tangent.truncate();
    let bitangent = front.cross(along) * frame.corners[0].w.signum();
    let gradient = SurfaceGradient::from_tangent_space(in_texture, along, bitangent);
    let gradient = if frame.is_turned {
        gradient * -1.0
    } else {
        gradient
    };
    Bumped {
        normal: gradient.apply(normal),
        variance: variance(in_texture),
    }
}

/// Eight bits a coordinate make a unit normal shorter by up to this, which is no roughness: a 255th in each direction by
/// rounding, and of x and y by another `1 - |x|` of it, as [`signed`] reads them. The greatest value of
/// `|z| + |x| (2 - |x|) + |y| (2 - |y|)` on the unit sphere is 2.224.
const ROUNDING: f32 = 2.224 / 255.0;

/// The variance of slopes of which a mean normal is left. Unit normals of variance s² have a mean of length
/// `1 / (1 + s²)`, about (Toksvig 2005).
fn variance(mean: Vec3) -> f32 {
    let length = (mean.length() + ROUNDING).clamp(0.05, 1.0);
    1.0 / length - 1.0
}

/// The mean of the normals under the footprint; shorter than 1 where they differ.
fn normal_of_texel(
    stage: &Stage<'_>,
    hit: &SurfaceHit,
    footprint: &Footprint,
    slot: TextureSlot,
    scale: f32,
) -> Vec3 {
    let uv = slot.coordinates(slot.texcoord(&texcoords(stage, hit)));
    let steps = footprint.of_texture(stage, hit, slot);
    let texel = sample(stage, slot, TextureUse::Data, uv, steps);
    let [x, y] = [texel.x, texel.y].map(signed);
    Vec3::new(x * scale, y * scale, texel.z * 2.0 - 1.0)
}

/// A number in [-1, 1] of one in [0, 1] that was kept in 8 bits. No code means 0; 127 and 128 lie beside it, and both are
/// written for it, so both are read as it.
fn signed(code: f32) -> f32 {
    const HALF_STEP: f32 = 1.0 / 255.0;
    let value = code * 2.0 - 1.0;
    // Rounding of filters must not let a bump through.
    let outside = value.abs() - HALF_STEP * 1.001;
    if outside > 0.0 {
        value.signum() * outside / (1.0 - HALF_STEP)
    } else {
        0.0
    }
}

/// The normal of `(-dh/dx, -dh/dy, 1)`, y upwards in the picture, by central differences over a texel or the sample's
/// footprint, whichever is larger.
fn normal_of_heights(
    stage: &Stage<'_>,
    hit: &SurfaceHit,
    footprint: &Footprint,
    slot: TextureSlot,
    depth: f32,
) -> Vec3 {
    let uv = slot.coordinates(slot.texcoord(&texcoords(stage, hit)));
    let steps = footprint.of_texture(stage, hit, slot);
    let pixels = stage.scene().images[stage.scene().textures[slot.texture].image].pixels();
    let texel = Vec2::new(pixels.width() as f32, pixels.height() as f32).recip();
    let seen = steps[0].abs().max(steps[1].abs());
    let half = seen.max(texel) * 0.5;
    if !half.is_finite() {
        return Vec3::Z;
    }
    let height = |offset: Vec2| {
        let texel: Vec4 = sample(stage, slot, TextureUse::Data, uv + offset, steps);
        (texel.x + texel.y + texel.z) / 3.0
    };
    let slope = |way: Vec2, half: f32| (height(way * half) - height(way * -half)) / (2.0 * half);
    let along_u = depth * slope(Vec2::X, half.x);
    let along_v = depth * slope(Vec2::Y, half.y);
    Vec3::new(-along_u, along_v, 1.0).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A normal as it comes back from 8 bits.
    fn kept_in_bytes(normal: Vec3) -> Vec3 {
        let code = |x: f32| ((x * 0.5 + 0.5) * 255.0).round() / 255.0;
        let [x, y] = [normal.x, normal.y].map(|x| signed(code(x)));
        Vec3::new(x, y, code(normal.z) * 2.0 - 1.0)
    }

    #[test]
    fn rounding_to_bytes_is_no_roughness() {
        let mut shortest: f32 = 1.0;
        for i in 0..200_u8 {
            for k in 0..200_u8 {
                let (turn, z) = (f32::from(i) * 0.031_416, (f32::from(k) + 0.5) / 200.0);
                let flat = Vec2::from_angle(turn) * (1.0 - z * z).sqrt();
                let kept = kept_in_bytes(flat.extend(z));
                assert_eq!(
                    variance(kept),
                    0.0,
                    "{flat}, {z}: {kept} of {}",
                    kept.length()
                );
                shortest = shortest.min(kept.length());
            }
        }
        assert!(
            1.0 - shortest > 0.5 * ROUNDING,
            "{shortest}: the bound is far from needed"
        );
    }

    #[test]
    fn normals_that_differ_leave_their_variance() {
        for slope in [0.2_f32, 0.4] {
            let mean = [slope, -slope].map(|s| Vec3::new(s, 0.0, 1.0).normalize() * 0.5);
            let found = variance(mean[0] + mean[1]);
            // The length is (1 + s²)^-1/2: along one direction half of what spreads along two.
            let expected = (1.0 + slope * slope).sqrt() - 1.0;
            assert!(
                (found - expected).abs() < 1.2 * ROUNDING,
                "{slope}: {found}, {expected}"
            );
        }
    }

    #[test]
    fn codes_beside_the_middle_are_flat_and_the_ends_are_kept() {
        for code in [127.0, 127.5, 128.0] {
            assert_eq!(signed(code / 255.0), 0.0, "{code}");
        }
        assert!((signed(1.0) - 1.0).abs() < 1e-4 && (signed(0.0) + 1.0).abs() < 1e-4);
        assert!(signed(129.0 / 255.0) > 0.0 && signed(126.0 / 255.0) < 0.0);
    }
}
