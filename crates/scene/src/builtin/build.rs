//! Building scenes in code: walls, boxes, turned and bent things, with normals and coordinates for textures.

use crate::{
    Camera, Face, Instance, Material, Mesh, Scene, Texture, TextureImage, TextureSlot, Units, Wrap,
};
use glam::{Affine2, Affine3A, Vec2, Vec3};
use hemicube_raster::{Image, Rgb};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Quads whose fourth corner is off the plane of the others by more than this share of their size are cut in two.
const PLANAR: f32 = 1e-5;

/// Collects a scene node by node.
///
/// [`node`](Self::node) opens a node; what is drawn afterwards belongs to it, one mesh per material. Coordinates for
/// textures are in metres along the surface (u to the right, v down), so a texture tiles at its true size; see
/// [`textured`](Self::textured). Faces that would have no area are left out, bent quads become two triangles.
#[derive(Debug, Clone)]
pub struct SceneBuilder {
    scene: Scene,
    node: String,
    world_from_node: Affine3A,
    node_from_part: Affine3A,
    /// Material and mesh of the open node.
    open: Vec<(usize, usize)>,
}

/// A corner of what is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Where it is.
    pub position: Vec3,
    /// Normal of unit length, on the front side.
    pub normal: Vec3,
    /// Coordinates of the texture.
    pub texcoord: Vec2,
}

/// A choice of the six sides of a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sides([bool; 6]);

impl Sides {
    /// All six.
    pub const ALL: Self = Self([true; 6]);
    /// Left (-x).
    pub const LEFT: usize = 0;
    /// Right (+x).
    pub const RIGHT: usize = 1;
    /// Below (-y).
    pub const BOTTOM: usize = 2;
    /// Above (+y).
    pub const TOP: usize = 3;
    /// Far from a viewer who looks along -z (-z).
    pub const BACK: usize = 4;
    /// Near to that viewer (+z).
    pub const FRONT: usize = 5;

    /// All but these.
    pub fn without(sides: &[usize]) -> Self {
        let mut kept = [true; 6];
        for &side in sides {
            kept[side] = false;
        }
        Self(kept)
    }

    /// Only these.
    pub fn only(sides: &[usize]) -> Self {
        Self(Self::without(sides).0.map(|kept| !kept))
    }

    /// Outward normal, direction to the right and upward direction of each side as seen from outside.
    const FRAMES: [[Vec3; 3]; 6] = [
        [Vec3::NEG_X, Vec3::Z, Vec3::Y],
        [Vec3::X, Vec3::NEG_Z, Vec3::Y],
        [Vec3::NEG_Y, Vec3::X, Vec3::Z],
        [Vec3::Y, Vec3::X, Vec3::NEG_Z],
        [Vec3::NEG_Z, Vec3::NEG_X, Vec3::Y],
        [Vec3::Z, Vec3::X, Vec3::Y],
    ];
}

impl SceneBuilder {
    /// An empty scene.
    pub fn new(name: &str, units: Units) -> Self {
        Self {
            scene: Scene {
                name: name.to_owned(),
                units,
                ..Scene::default()
            },
            node: name.to_owned(),
            world_from_node: Affine3A::IDENTITY,
            node_from_part: Affine3A::IDENTITY,
            open: Vec::new(),
        }
    }

    /// The scene.
    pub fn finish(self) -> Scene {
        self.scene
    }

    /// Adds a material.
    pub fn material(&mut self, material: Material) -> usize {
        self.scene.materials.push(material);
        self.scene.materials.len() - 1
    }

    /// Adds a matt material.
    pub fn diffuse(&mut self, name: &str, r: f32, g: f32, b: f32) -> usize {
        self.material(Material::diffuse(name, Rgb::new(r, g, b)))
    }

    /// Adds a material that reflects as its texture says; one copy of the texture covers `tile` metres.
    pub fn textured(&mut self, name: &str, texture: usize, tile: Vec2) -> usize {
        let transform = Affine2::from_scale(tile.recip());
        let slot = TextureSlot {
            transform,
            ..TextureSlot::new(texture)
        };
        self.material(Material {
            base_color_texture: Some(slot),
            ..Material::diffuse(name, Rgb::WHITE)
        })
    }

    /// Adds a texture.
    pub fn texture(&mut self, name: &str, wrap: Wrap, pixels: Image<[u8; 4]>) -> usize {
        self.scene
            .images
            .push(TextureImage::from_pixels(name, pixels));
        let image = self.scene.images.len() - 1;
        self.scene.textures.push(Texture::new(image, [wrap; 2]));
        self.scene.textures.len() - 1
    }

    /// Adds a view.
    pub fn camera(&mut self, camera: Camera) {
        self.scene.cameras.push(camera);
    }

    /// Adds views `(name, eye, what is in the middle of the picture, vertical angle in degrees)`, upright.
    pub fn views(&mut self, views: &[(&str, Vec3, Vec3, f32)]) {
        for &(name, eye, target, degrees) in views {
            let angle = degrees.to_radians();
            self.camera(Camera::looking_at(name, eye, target, Vec3::Y, angle));
        }
    }

    /// Opens a node at the origin of the world.
    pub fn node(&mut self, name: &str) {
        self.node_at(name, Affine3A::IDENTITY);
    }

    /// Opens a node; what is drawn in it is in its own coordinates.
    pub fn node_at(&mut self, name: &str, world_from_node: Affine3A) {
        self.node = name.to_owned();
        self.world_from_node = world_from_node;
        self.node_from_part = Affine3A::IDENTITY;
        self.open.clear();
    }

    /// Draws a part of the node in coordinates of its own.
    pub fn part(&mut self, node_from_part: Affine3A, draw: impl FnOnce(&mut Self)) {
        let outer = self.node_from_part;
        self.node_from_part = outer * node_from_part;
        draw(self);
        self.node_from_part = outer;
    }

    /// The mesh of a material in the open node.
    fn mesh(&mut self, material: usize) -> &mut Mesh {
        let found = self
            .open
            .iter()
            .find(|(of, _)| *of == material)
            .map(|&(_, mesh)| mesh);
        let mesh = found.unwrap_or_else(|| {
            let mesh = self.scene.meshes.len();
            let name = format!("{}/{}", self.node, self.scene.materials[material].name);
            self.scene.meshes.push(Mesh {
                name,
                material,
                texcoords: vec![Vec::new()],
                ..Mesh::default()
            });
            let (node, world_from_mesh) = (self.node.clone(), self.world_from_node);
            self.scene.instances.push(Instance {
                node,
                mesh,
                world_from_mesh,
                flipped: false,
            });
            self.open.push((material, mesh));
            mesh
        });
        &mut self.scene.meshes[mesh]
    }

    /// Adds vertices in coordinates of the part; gives the index of the first.
    fn vertices(&mut self, material: usize, vertices: impl Iterator<Item = Vertex>) -> u32 {
        let node_from_part = self.node_from_part;
        let normals_matrix = node_from_part.matrix3.inverse().transpose();
        let mesh = self.mesh(material);
        let first = index(mesh.positions.len());
        for vertex in vertices {
            mesh.positions
                .push(node_from_part.transform_point3(vertex.position));
            mesh.normals
                .push((normals_matrix * vertex.normal).normalize_or_zero());
            mesh.texcoords[0].push(vertex.texcoord);
        }
        first
    }

    /// Adds the face of four vertices; where corners fall together it is a triangle or nothing.
    fn face(&mut self, material: usize, corners: [u32; 4]) {
        let mesh = self.mesh(material);
        let at = |corner: u32| mesh.positions[corner as usize];
        let mut distinct: Vec<u32> = Vec::with_capacity(4);
        for (i, &corner) in corners.iter().enumerate() {
            if at(corner) != at(corners[(i + 1) % 4]) {
                distinct.push(corner);
            }
        }
        match distinct[..] {
            [a, b, c] => mesh.faces.push(Face::Triangle([a, b, c])),
            [a, b, c, d] if is_planar([at(a), at(b), at(c), at(d)]) => {
                mesh.faces.push(Face::Quad([a, b, c, d]));
            }
            [a, b, c, d] => mesh
                .faces
                .extend([Face::Triangle([a, b, c]), Face::Triangle([a, c, d])]),
            _ => {}
        }
    }

    /// Draws a polygon of four vertices, counter-clockwise.
    pub fn polygon(&mut self, material: usize, corners: [Vertex; 4]) {
        let first = self.vertices(material, corners.into_iter());
        self.face(material, [first, first + 1, first + 2, first + 3]);
    }

    /// Draws a flat quad, counter-clockwise; coordinates in metres from the first corner, which is the lower left one.
    pub fn quad(&mut self, material: usize, corners: [Vec3; 4]) {
        let right = (corners[1] - corners[0]).normalize_or_zero();
        let normal = right.cross(corners[3] - corners[0]).normalize_or_zero();
        let up = normal.cross(right);
        let texcoord = |p: Vec3| Vec2::new((p - corners[0]).dot(right), -(p - corners[0]).dot(up));
        self.polygon(
            material,
            corners.map(|position| Vertex {
                position,
                normal,
                texcoord: texcoord(position),
            }),
        );
    }

    /// Draws a flat quad that one copy of a picture fills, its first corner being the lower left one.
    pub fn picture(&mut self, material: usize, corners: [Vec3; 4]) {
        let normal = (corners[1] - corners[0])
            .cross(corners[3] - corners[0])
            .normalize_or_zero();
        let texcoords = [Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO];
        let vertex = |i: usize| Vertex {
            position: corners[i],
            normal,
            texcoord: texcoords[i],
        };
        self.polygon(material, [0, 1, 2, 3].map(vertex));
    }

    /// Draws the rectangle of `size` that starts in `origin`, without the holes `(low, high)` in it.
    ///
    /// The holes' edges run on across the rectangle, so that pieces share whole edges and subdivide alike.
    pub fn rectangle_with_holes(
        &mut self,
        material: usize,
        origin: Vec3,
        axes: [Vec3; 2],
        size: Vec2,
        holes: &[(Vec2, Vec2)],
    ) {
        let lines = |axis: usize| {
            let ends = holes.iter().flat_map(|(low, high)| [low[axis], high[axis]]);
            let mut lines: Vec<f32> = [0.0, size[axis]].into_iter().chain(ends).collect();
            lines.sort_by(f32::total_cmp);
            lines.dedup();
            lines
        };
        let (columns, rows) = (lines(0), lines(1));
        let normal = axes[0].cross(axes[1]);
        let vertex = |(u, v): (f32, f32)| Vertex {
            position: origin + axes[0] * u + axes[1] * v,
            normal,
            texcoord: Vec2::new(u, -v),
        };
        let corners = rows
            .iter()
            .flat_map(|&v| columns.iter().map(move |&u| (u, v)));
        let first = self.vertices(material, corners.map(vertex));
        let at = |row: usize, column: usize| first + index(row * columns.len() + column);
        for (row, v) in rows.windows(2).enumerate() {
            for (column, u) in columns.windows(2).enumerate() {
                let centre = Vec2::new(u[0] + u[1], v[0] + v[1]) * 0.5;
                if !holes
                    .iter()
                    .any(|(low, high)| centre.cmpgt(*low).all() && centre.cmplt(*high).all())
                {
                    self.face(
                        material,
                        [
                            at(row, column),
                            at(row, column + 1),
                            at(row + 1, column + 1),
                            at(row + 1, column),
                        ],
                    );
                }
            }
        }
    }

    /// Draws a box seen from outside; the grain of its texture (u) runs along its longest edge.
    pub fn cuboid(&mut self, material: usize, low: Vec3, high: Vec3, sides: Sides) {
        let size = high - low;
        for (kept, [normal, right, up]) in sides.0.into_iter().zip(Sides::FRAMES) {
            let (half_right, half_up) = (
                right * size.dot(right.abs()) * 0.5,
                up * size.dot(up.abs()) * 0.5,
            );
            let centre = (low + high + normal * size) * 0.5;
            let along = half_up.length() <= half_right.length();
            let corner = |s: f32, t: f32| {
                let position = centre + half_right * s + half_up * t;
                let (a, b) = (position.dot(right), position.dot(up));
                let texcoord = if along {
                    Vec2::new(a, -b)
                } else {
                    Vec2::new(b, a)
                };
                Vertex {
                    position,
                    normal,
                    texcoord,
                }
            };
            if kept {
                self.polygon(
                    material,
                    [
                        corner(-1.0, -1.0),
                        corner(1.0, -1.0),
                        corner(1.0, 1.0),
                        corner(-1.0, 1.0),
                    ],
                );
            }
        }
    }

    /// Draws a box seen from inside.
    pub fn room(&mut self, material: usize, low: Vec3, high: Vec3, sides: Sides) {
        let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5);
        for (kept, [outward, right, up]) in sides.0.into_iter().zip(Sides::FRAMES) {
            let corner = |s: f32, t: f32| centre + (outward - right * s + up * t) * half;
            if kept {
                self.quad(
                    material,
                    [
                        corner(-1.0, -1.0),
                        corner(1.0, -1.0),
                        corner(1.0, 1.0),
                        corner(-1.0, 1.0),
                    ],
                );
            }
        }
    }

    /// Draws a grid of vertices: columns go to the right, rows upward as seen from the front; neighbours share them.
    fn grid(
        &mut self,
        material: usize,
        rows: usize,
        columns: usize,
        vertex: impl Fn(usize, usize) -> Vertex,
    ) {
        let all = (0..rows * columns).map(|i| vertex(i / columns, i % columns));
        let first = self.vertices(material, all);
        let at = |row: usize, column: usize| first + index(row * columns + column);
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                self.face(
                    material,
                    [
                        at(row, column),
                        at(row, column + 1),
                        at(row + 1, column + 1),
                        at(row + 1, column),
                    ],
                );
            }
        }
    }

    /// Draws a sheet of vertices `(row, column)`; columns go to the right, rows upward as seen from the front.
    ///
    /// Normals are smooth, coordinates are metres along the first row and column.
    pub fn sheet(
        &mut self,
        material: usize,
        rows: usize,
        columns: usize,
        position: impl Fn(usize, usize) -> Vec3,
    ) {
        let step = |row: usize, column: usize| {
            let (left, right) = (column.saturating_sub(1), (column + 1).min(columns - 1));
            let (below, above) = (row.saturating_sub(1), (row + 1).min(rows - 1));
            (
                position(row, right) - position(row, left),
                position(above, column) - position(below, column),
            )
        };
        let length = |n: usize, at: &dyn Fn(usize) -> Vec3| {
            (0..n).map(|i| at(i).distance(at(i + 1))).sum::<f32>()
        };
        self.grid(material, rows, columns, |row, column| {
            let (along, up) = step(row, column);
            let (middle_row, middle_column) = (rows / 2, columns / 2);
            Vertex {
                position: position(row, column),
                normal: along.cross(up).normalize_or_zero(),
                texcoord: Vec2::new(
                    length(column, &|i| position(middle_row, i)),
                    -length(row, &|i| position(i, middle_column)),
                ),
            }
        });
    }

    /// Draws a bent plate from `position(u, v, w)`, all in [0, 1]: u to the right, v upward, w from its back to its front.
    pub fn plate(
        &mut self,
        material: usize,
        columns: usize,
        rows: usize,
        position: impl Fn(f32, f32, f32) -> Vec3,
    ) {
        let (u, v) = (
            |i: usize| i as f32 / columns as f32,
            |i: usize| i as f32 / rows as f32,
        );
        let end = |i: usize| i as f32;
        self.sheet(material, rows + 1, columns + 1, |r, c| {
            position(u(c), v(r), 1.0)
        });
        self.sheet(material, rows + 1, columns + 1, |r, c| {
            position(u(columns - c), v(r), 0.0)
        });
        self.sheet(material, 2, columns + 1, |r, c| position(u(c), 0.0, end(r)));
        self.sheet(material, 2, columns + 1, |r, c| {
            position(u(c), 1.0, end(1 - r))
        });
        self.sheet(material, rows + 1, 2, |r, c| position(0.0, v(r), end(c)));
        self.sheet(material, rows + 1, 2, |r, c| {
            position(1.0, v(r), end(1 - c))
        });
    }

    /// Turns a profile of `(radius, height)` around the y axis.
    ///
    /// Where the profile goes up, the front is outside; where it goes down, inside. It is smooth but for points that are
    /// given twice. Points on the axis close it.
    pub fn lathe(&mut self, material: usize, profile: &[(f32, f32)], segments: usize) {
        let widest = profile
            .iter()
            .fold(0.0_f32, |widest, point| widest.max(point.0));
        let normals = profile_normals(profile);
        let mut lengths = vec![0.0];
        for pair in profile.windows(2) {
            let step = (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1);
            lengths.push(lengths[lengths.len() - 1] + step);
        }
        self.grid(material, profile.len(), segments + 1, |row, column| {
            let (sin, cos) = around(column, segments);
            let ((radius, height), normal) = (profile[row], normals[row]);
            Vertex {
                position: Vec3::new(radius * cos, height, -radius * sin),
                normal: Vec3::new(normal.x * cos, normal.y, -normal.x * sin),
                texcoord: Vec2::new(
                    TAU * widest * column as f32 / segments as f32,
                    -lengths[row],
                ),
            }
        });
    }

    /// Draws an upright cylinder on `base`, with or without its lower and upper disc.
    pub fn cylinder(
        &mut self,
        material: usize,
        base: Vec3,
        radius: f32,
        height: f32,
        segments: usize,
        discs: [bool; 2],
    ) {
        let mut profile = vec![(radius, 0.0), (radius, height)];
        if discs[0] {
            profile.splice(0..0, [(0.0, 0.0), (radius, 0.0)]);
        }
        if discs[1] {
            profile.extend([(radius, height), (0.0, height)]);
        }
        self.part(Affine3A::from_translation(base), |b| {
            b.lathe(material, &profile, segments);
        });
    }

    /// Draws a sphere.
    pub fn sphere(&mut self, material: usize, centre: Vec3, radius: f32, segments: usize) {
        let rings = (segments / 2).max(2);
        let profile: Vec<(f32, f32)> = (0..=rings)
            .map(|i| match i {
                0 => (0.0, -radius),
                _ if i == rings => (0.0, radius),
                _ => {
                    let (sin, cos) = (FRAC_PI_2 * (2.0 * i as f32 / rings as f32 - 1.0)).sin_cos();
                    (radius * cos, radius * sin)
                }
            })
            .collect();
        self.part(Affine3A::from_translation(centre), |b| {
            b.lathe(material, &profile, segments);
        });
    }

    /// Draws a round bar along a polyline, closed at both ends.
    pub fn tube(&mut self, material: usize, path: &[Vec3], radius: f32, segments: usize) {
        let frames = tube_frames(path);
        let last = path.len() - 1;
        self.grid(material, path.len() + 4, segments + 1, |row, column| {
            let point = row.saturating_sub(2).min(last);
            let [tangent, side, up] = frames[point];
            let (sin, cos) = around(column, segments);
            let radial = side * cos + up * sin;
            let (scale, normal) = match row {
                0 => (0.0, -tangent),
                1 => (radius, -tangent),
                _ if row == last + 4 => (0.0, tangent),
                _ if row == last + 3 => (radius, tangent),
                _ => (radius, radial),
            };
            let along = path[..=point]
                .windows(2)
                .map(|pair| pair[0].distance(pair[1]))
                .sum::<f32>();
            Vertex {
                position: path[point] + radial * scale,
                normal,
                texcoord: Vec2::new(along, TAU * radius * column as f32 / segments as f32),
            }
        });
    }

    /// Draws a box whose edges and corners are rounded in `steps` facets.
    pub fn rounded(&mut self, material: usize, low: Vec3, high: Vec3, radius: f32, steps: usize) {
        let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let radius = radius.min(half.min_element());
        let columns = 4 * (steps + 1);
        let rows = 2 * (steps + 1);
        let vertex = |row: usize, column: usize| {
            let (quadrant, step) = ((column / (steps + 1)) % 4, column % (steps + 1));
            let (a, b) = quarter(step, steps);
            let (x, z) = [(b, -a), (-a, -b), (-b, a), (a, b)][quadrant];
            let signs = [
                Vec2::new(1.0, -1.0),
                -Vec2::ONE,
                Vec2::new(-1.0, 1.0),
                Vec2::ONE,
            ][quadrant];
            let upper = row > steps;
            let (y, flat) = if upper {
                quarter(row - steps - 1, steps)
            } else {
                quarter(steps - row, steps)
            };
            let sign = if upper { 1.0 } else { -1.0 };
            let normal = Vec3::new(x * flat, y * sign, z * flat);
            let inner = Vec3::new(signs.x, sign, signs.y) * (half - radius);
            (centre + inner + normal * radius, normal)
        };
        for row in 0..rows - 1 {
            for column in 0..columns {
                let next = (column + 1) % columns;
                let corners = [
                    (row, column),
                    (row, next),
                    (row + 1, next),
                    (row + 1, column),
                ];
                self.boxed(material, corners.map(|(row, column)| vertex(row, column)));
            }
        }
        let pole = |row: usize, quadrant: usize| vertex(row, quadrant * (steps + 1));
        self.boxed(
            material,
            [
                pole(rows - 1, 0),
                pole(rows - 1, 1),
                pole(rows - 1, 2),
                pole(rows - 1, 3),
            ],
        );
        self.boxed(material, [pole(0, 3), pole(0, 2), pole(0, 1), pole(0, 0)]);
    }

    /// Draws a polygon with the coordinates of the side of a box that it faces most.
    fn boxed(&mut self, material: usize, corners: [(Vec3, Vec3); 4]) {
        let facing = corners.iter().map(|c| c.1).sum::<Vec3>();
        let [_, right, up] = Sides::FRAMES
            .into_iter()
            .max_by(|a, b| a[0].dot(facing).total_cmp(&b[0].dot(facing)))
            .expect("a box has sides");
        self.polygon(
            material,
            corners.map(|(position, normal)| Vertex {
                position,
                normal,
                texcoord: Vec2::new(position.dot(right), -position.dot(up)),
            }),
        );
    }
}

/// Index of a vertex as faces store it.
fn index(i: usize) -> u32 {
    u32::try_from(i).expect("a built-in mesh has fewer than 2^32 vertices")
}

fn is_planar([a, b, c, d]: [Vec3; 4]) -> bool {
    let normal = (c - a).cross(d - b).normalize_or_zero();
    let size = (c - a).length().max((d - b).length());
    normal.dot(b - a).abs() <= PLANAR * size
}

/// Sine and cosine of a column's angle; the last column is exactly the first.
fn around(column: usize, segments: usize) -> (f32, f32) {
    (TAU * (column % segments) as f32 / segments as f32).sin_cos()
}

/// Sine and cosine of a step of a quarter turn, exact at its ends.
fn quarter(step: usize, steps: usize) -> (f32, f32) {
    match step {
        0 => (0.0, 1.0),
        _ if step == steps => (1.0, 0.0),
        _ => (FRAC_PI_2 * step as f32 / steps as f32).sin_cos(),
    }
}

/// Normals `(outward, upward)` of the points of a lathe's profile.
fn profile_normals(profile: &[(f32, f32)]) -> Vec<Vec2> {
    let across = |i: usize| {
        let step = Vec2::from(profile[i + 1]) - Vec2::from(profile[i]);
        Vec2::new(step.y, -step.x).normalize_or_zero()
    };
    (0..profile.len())
        .map(|i| {
            let before = if i > 0 { across(i - 1) } else { Vec2::ZERO };
            let after = if i + 1 < profile.len() {
                across(i)
            } else {
                Vec2::ZERO
            };
            let normal = (before + after).normalize_or_zero();
            // On the axis all directions meet.
            if profile[i].0 == 0.0 && normal.y != 0.0 {
                Vec2::new(0.0, normal.y.signum())
            } else {
                normal
            }
        })
        .collect()
}

/// Tangent and two directions across it at each point of a polyline, turned as little as possible along the way.
fn tube_frames(path: &[Vec3]) -> Vec<[Vec3; 3]> {
    let last = path.len() - 1;
    let mut side: Option<Vec3> = None;
    (0..path.len())
        .map(|i| {
            let tangent =
                (path[(i + 1).min(last)] - path[i.saturating_sub(1)]).normalize_or(Vec3::Y);
            let start = side.unwrap_or_else(|| tangent.any_orthonormal_vector());
            let across = start
                .reject_from_normalized(tangent)
                .normalize_or(tangent.any_orthonormal_vector());
            side = Some(across);
            [tangent, across, tangent.cross(across)]
        })
        .collect()
}
