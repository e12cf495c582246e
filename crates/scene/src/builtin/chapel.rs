//! A chapel with a thick southern wall of 113 small windows under a roof like a shell, after Ronchamp's.
//!
//! 24 x 12 m. Windows are funnels through the wall, wider inside, with tinted panes at their ends: each is an area light.
//! Luminance in cd/m².

use super::build::{SceneBuilder, Sides};
use crate::{Material, Scene, Units};
use glam::{Affine3A, Vec2, Vec3};
use hemicube_raster::Rgb;

/// Length (x) and width (z).
const NAVE: Vec2 = Vec2::new(24.0, 12.0);
/// Height up to which the southern wall is cut into fields, one for each window.
const FIELDS: f32 = 6.0;
/// Windows of the southern wall.
pub(super) const WINDOWS: usize = 113;
/// Height of the slit between wall and roof.
const SLIT: f32 = 0.12;

struct Palette {
    wall: usize,
    roof: usize,
    floor: usize,
    stone: usize,
    wood: usize,
    bronze: usize,
    sky: usize,
    panes: Vec<usize>,
}

impl Palette {
    fn new(b: &mut SceneBuilder) -> Self {
        let mut pane = |name: &str, r: f32, g: f32, blue: f32| {
            b.material(Material {
                emission: Rgb::new(r, g, blue),
                ..Material::diffuse(name, Rgb::new(0.15, 0.15, 0.15))
            })
        };
        let panes = vec![
            pane("pane-clear", 5200.0, 5500.0, 5900.0),
            pane("pane-white", 3900.0, 3800.0, 3500.0),
            pane("pane-blue", 240.0, 620.0, 2900.0),
            pane("pane-red", 2300.0, 150.0, 90.0),
            pane("pane-yellow", 4200.0, 2500.0, 170.0),
            pane("pane-green", 250.0, 1500.0, 420.0),
            pane("pane-violet", 700.0, 180.0, 1300.0),
        ];
        let sky = pane("slit", 2600.0, 2900.0, 3400.0);
        Self {
            wall: b.diffuse("lime-wash", 0.78, 0.76, 0.71),
            roof: b.diffuse("concrete", 0.34, 0.32, 0.29),
            floor: b.diffuse("flags", 0.33, 0.30, 0.26),
            stone: b.diffuse("stone", 0.62, 0.59, 0.52),
            wood: b.diffuse("iroko", 0.22, 0.12, 0.06),
            bronze: b.diffuse("bronze", 0.28, 0.20, 0.11),
            sky,
            panes,
        }
    }
}

/// The chapel.
pub(super) fn scene() -> Scene {
    let mut builder = SceneBuilder::new("chapel", Units::Photometric);
    let palette = Palette::new(&mut builder);
    floor(&mut builder, &palette);
    southern_wall(&mut builder, &palette);
    other_walls(&mut builder, &palette);
    roof(&mut builder, &palette);
    altar(&mut builder, &palette);
    pews(&mut builder, &palette);
    gallery(&mut builder, &palette);
    builder.views(&[
        (
            "nave",
            Vec3::new(3.3, 1.7, 10.3),
            Vec3::new(17.0, 2.6, 3.0),
            68.0,
        ),
        (
            "windows",
            Vec3::new(11.5, 1.7, 11.2),
            Vec3::new(11.0, 2.9, 0.0),
            74.0,
        ),
        (
            "altar",
            Vec3::new(21.5, 2.3, 8.8),
            Vec3::new(5.5, 2.4, 3.6),
            66.0,
        ),
    ]);
    builder.finish()
}

/// A number in [0, 1) for two whole ones, the same every time.
fn chance(a: usize, b: usize) -> f32 {
    let x = (a as f32 * 12.9898 + b as f32 * 78.233).sin() * 43_758.547;
    x - x.floor()
}

/// Height of the roof's underside: it sags in the middle and rises to the south-east.
fn roof_at(x: f32, z: f32) -> f32 {
    let (u, v) = (x / NAVE.x, z / NAVE.y);
    let sag =
        -1.5 * (1.0 - (2.0 * v - 0.9).powi(2)) * (0.55 + 0.45 * (core::f32::consts::PI * u).sin());
    6.9 + 2.6 * u * u - 0.9 * v + sag
}

fn floor(b: &mut SceneBuilder, m: &Palette) {
    b.node("floor");
    b.sheet(m.floor, 7, 13, |row, column| {
        // It falls towards the altar, as the hill does.
        let x = NAVE.x * column as f32 / 12.0;
        Vec3::new(x, ground(x), NAVE.y * (1.0 - row as f32 / 6.0))
    });
}

fn ground(x: f32) -> f32 {
    -0.45 * (x / NAVE.x)
}

/// Fields `(low, high)` in x and y: the largest is cut until there are enough.
fn fields() -> Vec<(Vec2, Vec2)> {
    let mut fields = vec![(Vec2::new(0.6, 0.35), Vec2::new(NAVE.x - 1.2, FIELDS))];
    while fields.len() < WINDOWS {
        let n = fields.len();
        let weight = |i: usize| {
            let size: Vec2 = fields[i].1 - fields[i].0;
            size.x * size.y * (0.55 + 0.9 * chance(i, n))
        };
        let largest = (0..n)
            .max_by(|&i, &j| weight(i).total_cmp(&weight(j)))
            .expect("there is one");
        let (low, high) = fields[largest];
        let size = high - low;
        let share = 0.34 + 0.32 * chance(n, 3);
        let axis = usize::from(size.y * (0.8 + 0.5 * chance(n, 7)) > size.x);
        let mut cut = [low, high];
        cut[0][axis] = low[axis] + size[axis] * share;
        cut[1][axis] = cut[0][axis];
        fields[largest] = (
            low,
            if axis == 0 {
                Vec2::new(cut[1].x, high.y)
            } else {
                Vec2::new(high.x, cut[1].y)
            },
        );
        fields.push((
            if axis == 0 {
                Vec2::new(cut[0].x, low.y)
            } else {
                Vec2::new(low.x, cut[0].y)
            },
            high,
        ));
    }
    fields
}

fn southern_wall(b: &mut SceneBuilder, m: &Palette) {
    b.node("southern-wall");
    // Around the fields.
    let (left, right, below) = (0.6, NAVE.x - 1.2, 0.35);
    let size = Vec2::new(NAVE.x, FIELDS + 0.45);
    b.rectangle_with_holes(
        m.wall,
        Vec3::new(0.0, -0.45, 0.0),
        [Vec3::X, Vec3::Y],
        size,
        &[(
            Vec2::new(left, below + 0.45),
            Vec2::new(right, FIELDS + 0.45),
        )],
    );
    let edge = |x: f32| roof_at(x, 0.0) - SLIT;
    let columns = 25;
    let at = |column: usize| NAVE.x * column as f32 / (columns - 1) as f32;
    b.sheet(m.wall, 2, columns, |row, column| {
        let x = at(column);
        Vec3::new(x, if row == 0 { FIELDS } else { edge(x) }, 0.0)
    });
    for (i, &(low, high)) in fields().iter().enumerate() {
        let size = high - low;
        let hole = size * Vec2::new(0.34 + 0.34 * chance(i, 11), 0.32 + 0.38 * chance(i, 13));
        let free = size - hole;
        let from = low + free * Vec2::new(0.25 + 0.5 * chance(i, 17), 0.25 + 0.5 * chance(i, 19));
        let to = from + hole;
        b.rectangle_with_holes(
            m.wall,
            low.extend(0.0),
            [Vec3::X, Vec3::Y],
            size,
            &[(from - low, to - low)],
        );
        window(b, m, i, from, to);
    }
    b.node("slit");
    b.sheet(m.sky, 2, columns, |row, column| {
        let x = at(column);
        Vec3::new(x, edge(x) + SLIT * row as f32, -0.02)
    });
}

/// A funnel through the wall: four splays and a pane at their end.
fn window(b: &mut SceneBuilder, m: &Palette, i: usize, from: Vec2, to: Vec2) {
    b.node(&format!("window-{}", i + 1));
    // The wall is thick in the west and thin in the east.
    let depth = 2.3 - 1.6 * from.x / NAVE.x;
    let narrow = Vec2::new(0.3 + 0.35 * chance(i, 23), 0.3 + 0.4 * chance(i, 29));
    let free = (to - from) * (Vec2::ONE - narrow);
    let low = from + free * Vec2::new(chance(i, 31), chance(i, 37));
    let high = low + (to - from) * narrow;
    let inner = [from, Vec2::new(to.x, from.y), to, Vec2::new(from.x, to.y)].map(|p| p.extend(0.0));
    let outer = [
        low,
        Vec2::new(high.x, low.y),
        high,
        Vec2::new(low.x, high.y),
    ]
    .map(|p| p.extend(-depth));
    for k in 0..4 {
        let next = (k + 1) % 4;
        b.quad(m.wall, [inner[k], inner[next], outer[next], outer[k]]);
    }
    let tint = chance(i, 41);
    let pane = match tint {
        t if t < 0.42 => 0,
        t if t < 0.60 => 1,
        t if t < 0.72 => 2,
        t if t < 0.82 => 3,
        t if t < 0.91 => 4,
        t if t < 0.97 => 5,
        _ => 6,
    };
    b.quad(m.panes[pane], outer);
}

fn other_walls(b: &mut SceneBuilder, m: &Palette) {
    let steps = 13;
    let z = |column: usize| NAVE.y * column as f32 / (steps - 1) as f32;
    b.node("eastern-wall");
    // Seen from inside, south is on the left when one looks east.
    b.sheet(m.wall, 9, steps, |row, column| {
        let top = roof_at(NAVE.x, z(column)) - SLIT;
        let foot = ground(NAVE.x);
        Vec3::new(NAVE.x, foot + (top - foot) * row as f32 / 8.0, z(column))
    });
    b.node("eastern-slit");
    b.sheet(m.sky, 2, steps, |row, column| {
        let top = roof_at(NAVE.x, z(column));
        Vec3::new(NAVE.x + 0.02, top - SLIT * (1 - row) as f32, z(column))
    });
    b.node("western-wall");
    b.sheet(m.wall, 9, steps, |row, column| {
        let z = NAVE.y - z(column);
        let top = roof_at(0.0, z);
        Vec3::new(0.0, top * row as f32 / 8.0, z)
    });
    b.node("northern-wall");
    b.sheet(m.wall, 9, 25, |row, column| {
        let x = NAVE.x * (1.0 - column as f32 / 24.0);
        let (foot, top) = (ground(x), roof_at(x, NAVE.y));
        Vec3::new(x, foot + (top - foot) * row as f32 / 8.0, NAVE.y)
    });
    b.node("towers");
    // Half-round chapels lean on the northern wall.
    for x in [4.2_f32, 14.6] {
        b.sheet(m.wall, 7, 17, |row, column| {
            let angle = core::f32::consts::PI * column as f32 / 16.0;
            let place = Vec2::new(x + 1.3 * angle.cos(), NAVE.y - 1.3 * angle.sin());
            let (foot, top) = (ground(x) - 0.1, 4.3);
            Vec3::new(place.x, foot + (top - foot) * row as f32 / 6.0, place.y)
        });
        b.sheet(m.wall, 2, 17, |row, column| {
            let angle = core::f32::consts::PI * column as f32 / 16.0;
            let radius = 1.3 * (1.0 - row as f32);
            Vec3::new(x + radius * angle.cos(), 4.3, NAVE.y - radius * angle.sin())
        });
    }
}

fn roof(b: &mut SceneBuilder, m: &Palette) {
    b.node("roof");
    // Seen from below.
    b.sheet(m.roof, 13, 25, |row, column| {
        let (x, z) = (NAVE.x * column as f32 / 24.0, NAVE.y * row as f32 / 12.0);
        Vec3::new(x, roof_at(x, z), z)
    });
}

fn altar(b: &mut SceneBuilder, m: &Palette) {
    b.node("altar");
    let foot = ground(NAVE.x);
    b.cuboid(
        m.stone,
        Vec3::new(19.0, foot - 0.1, 2.2),
        Vec3::new(23.4, foot + 0.17, 9.2),
        Sides::without(&[Sides::BOTTOM]),
    );
    b.cuboid(
        m.stone,
        Vec3::new(19.7, foot + 0.17, 2.9),
        Vec3::new(23.0, foot + 0.34, 8.5),
        Sides::without(&[Sides::BOTTOM]),
    );
    let top = foot + 0.34;
    b.cuboid(
        m.stone,
        Vec3::new(21.0, top, 4.4),
        Vec3::new(22.0, top + 0.92, 7.0),
        Sides::without(&[Sides::BOTTOM]),
    );
    b.cuboid(
        m.stone,
        Vec3::new(20.85, top + 0.92, 4.2),
        Vec3::new(22.15, top + 1.06, 7.2),
        Sides::ALL,
    );
    for z in [4.5, 5.1, 6.3, 6.9] {
        b.part(
            Affine3A::from_translation(Vec3::new(21.9, top + 1.06, z)),
            |b| {
                let profile = [
                    (0.0, 0.0),
                    (0.07, 0.0),
                    (0.07, 0.0),
                    (0.05, 0.03),
                    (0.012, 0.08),
                    (0.012, 0.34),
                    (0.03, 0.38),
                    (0.03, 0.38),
                    (0.0, 0.38),
                ];
                b.lathe(m.bronze, &profile, 12);
            },
        );
    }
    b.node("cross");
    b.cuboid(
        m.wood,
        Vec3::new(22.55, top, 8.0),
        Vec3::new(22.70, top + 3.1, 8.15),
        Sides::without(&[Sides::BOTTOM]),
    );
    b.cuboid(
        m.wood,
        Vec3::new(22.56, top + 2.2, 7.35),
        Vec3::new(22.69, top + 2.34, 8.0),
        Sides::without(&[Sides::FRONT]),
    );
    b.cuboid(
        m.wood,
        Vec3::new(22.56, top + 2.2, 8.15),
        Vec3::new(22.69, top + 2.34, 8.8),
        Sides::without(&[Sides::BACK]),
    );
    b.node("pulpit");
    b.part(
        Affine3A::from_translation(Vec3::new(18.2, ground(18.2) - 0.05, 10.6)),
        |b| {
            let profile = [
                (0.0, 0.0),
                (0.35, 0.0),
                (0.35, 0.0),
                (0.3, 1.2),
                (0.75, 1.7),
                (0.75, 1.7),
                (0.75, 2.7),
                (0.75, 2.7),
                (0.67, 2.7),
                (0.67, 2.7),
                (0.67, 1.75),
                (0.67, 1.75),
                (0.0, 1.75),
            ];
            b.lathe(m.wall, &profile, 24);
        },
    );
}

/// Eight long benches stand together on the side of the windows.
fn pews(b: &mut SceneBuilder, m: &Palette) {
    for row in 0..8 {
        b.node(&format!("pew-{}", row + 1));
        let x = 7.6 + 1.25 * row as f32;
        let foot = ground(x + 0.3);
        let (near, far) = (2.0 + 0.16 * row as f32, 7.6);
        for z in [near, (near + far) * 0.5 - 0.1, far - 0.2] {
            b.cuboid(
                m.stone,
                Vec3::new(x, foot - 0.05, z),
                Vec3::new(x + 0.42, foot + 0.38, z + 0.2),
                Sides::without(&[Sides::BOTTOM, Sides::TOP]),
            );
        }
        b.cuboid(
            m.wood,
            Vec3::new(x - 0.02, foot + 0.38, near),
            Vec3::new(x + 0.46, foot + 0.45, far),
            Sides::ALL,
        );
        b.cuboid(
            m.wood,
            Vec3::new(x - 0.10, foot + 0.60, near),
            Vec3::new(x - 0.04, foot + 0.92, far),
            Sides::ALL,
        );
        for z in [near + 0.1, far - 0.25] {
            b.cuboid(
                m.wood,
                Vec3::new(x - 0.09, foot + 0.40, z),
                Vec3::new(x - 0.05, foot + 0.60, z + 0.12),
                Sides::without(&[Sides::TOP, Sides::BOTTOM]),
            );
        }
    }
}

/// The singers' balcony over the western end.
fn gallery(b: &mut SceneBuilder, m: &Palette) {
    b.node("gallery");
    let (low, high) = (Vec3::new(0.0, 2.75, 4.0), Vec3::new(2.9, 2.98, NAVE.y));
    b.cuboid(
        m.roof,
        low,
        high,
        Sides::without(&[Sides::LEFT, Sides::FRONT]),
    );
    let rail = Vec3::new(high.x, high.y + 0.95, NAVE.y);
    b.cuboid(
        m.wall,
        Vec3::new(high.x - 0.14, high.y, 4.0),
        rail,
        Sides::without(&[Sides::BOTTOM, Sides::FRONT]),
    );
    b.cuboid(
        m.wall,
        Vec3::new(0.0, high.y, 4.0),
        Vec3::new(high.x - 0.14, rail.y, 4.14),
        Sides::without(&[Sides::BOTTOM, Sides::LEFT, Sides::RIGHT]),
    );
    b.cylinder(
        m.stone,
        Vec3::new(2.5, -0.06, 4.5),
        0.16,
        2.81,
        16,
        [false, false],
    );
    b.cylinder(
        m.stone,
        Vec3::new(2.5, -0.06, 9.0),
        0.16,
        2.81,
        16,
        [false, false],
    );
}
