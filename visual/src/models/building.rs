//! The faces of a building: the same solid that shells meet ([`BuildingSolid`]), painted.
//!
//! A wall's windows are not geometry: it carries how many windows and storeys it has, and the shader draws them. Colours
//! are albedos of weathered materials (plaster 0.3 to 0.5, brick 0.15 to 0.3, clay tiles 0.1 to 0.2, gravel and concrete
//! 0.15 to 0.3), chosen by class and by a hash of the place.

use super::mesh::{Mesh, Paint, size_code};
use glam::{DVec2, DVec3, Vec2, Vec3};
use terrain::features::model::BuildingClass;
use terrain::features::solid::{BuildingSolid, FOOT_M, RoofKind, doubled_area_m2, hash_of, pairs, triangulated};

const PLASTER: [Paint; 10] = [
    Paint::matt(0.44, 0.42, 0.37),
    Paint::matt(0.47, 0.45, 0.42),
    Paint::matt(0.43, 0.38, 0.30),
    Paint::matt(0.40, 0.35, 0.27),
    Paint::matt(0.45, 0.43, 0.39),
    Paint::matt(0.37, 0.30, 0.24),
    Paint::matt(0.41, 0.41, 0.38),
    Paint::matt(0.42, 0.36, 0.30),
    Paint::matt(0.35, 0.34, 0.32),
    Paint::matt(0.24, 0.15, 0.11),
];
const SHEET: [Paint; 4] = [
    Paint::matt(0.42, 0.42, 0.42),
    Paint::matt(0.34, 0.36, 0.38),
    Paint::matt(0.45, 0.44, 0.41),
    Paint::matt(0.26, 0.30, 0.32),
];
const WOOD: [Paint; 3] = [Paint::matt(0.20, 0.15, 0.11), Paint::matt(0.27, 0.20, 0.14), Paint::matt(0.38, 0.34, 0.28)];
const STONE: [Paint; 2] = [Paint::matt(0.38, 0.35, 0.30), Paint::matt(0.46, 0.45, 0.41)];
const TILES: [Paint; 6] = [
    Paint::matt(0.185, 0.105, 0.080),
    Paint::matt(0.160, 0.098, 0.080),
    Paint::matt(0.210, 0.125, 0.095),
    Paint::matt(0.140, 0.100, 0.085),
    Paint::matt(0.105, 0.098, 0.095),
    Paint::matt(0.085, 0.085, 0.090),
];
const LEVEL: [Paint; 5] = [
    Paint::matt(0.22, 0.22, 0.20),
    Paint::matt(0.26, 0.25, 0.23),
    Paint::matt(0.17, 0.17, 0.17),
    Paint::matt(0.25, 0.20, 0.17),
    Paint::matt(0.29, 0.28, 0.27),
];

/// Plan of the smallest hall, square metres.
const HALL_M2: f64 = 1_000.0;

/// The walls' windows and colours by class.
struct Style {
    wall: Paint,
    roof: Paint,
    /// Metres from window to window and from storey to storey.
    window_m: f64,
    storey_m: f64,
}

fn style(class: BuildingClass, roof: RoofKind, hash: u32) -> Style {
    use BuildingClass as C;
    let pick = |of: &[Paint], bits: u32| of[(hash >> bits) as usize % of.len()];
    let shade = 0.88 + 0.2 * ((hash >> 24) & 15) as f32 / 15.0;
    let (wall, kind, window_m, storey_m) = match class {
        C::House | C::Other => (pick(&PLASTER, 3), 1, 3.0, 2.9),
        C::Apartments => (pick(&PLASTER[..9], 3), 1, 2.9, 3.0),
        C::Commercial if hash & 3 == 0 => (pick(&SHEET, 3), 2, 3.2, 3.6),
        C::Commercial => (pick(&PLASTER[..9], 3), 1, 3.0, 3.4),
        C::Industrial => (pick(&SHEET, 3), 2, 6.0, 5.0),
        C::Church => (pick(&STONE, 3), 0, 5.0, 6.0),
        C::Hangar => (pick(&SHEET, 3), 0, 5.0, 5.0),
        C::Barn => (pick(&WOOD, 3), 0, 5.0, 4.0),
    };
    let roof = match (roof, class) {
        (RoofKind::Pitched, C::Industrial | C::Barn) if hash & 16 == 0 => pick(&SHEET, 8).shaded(0.7),
        (RoofKind::Pitched, _) => pick(&TILES, 8),
        (RoofKind::Barrel, _) => pick(&SHEET, 8).shaded(0.85),
        (RoofKind::Flat, _) => pick(&LEVEL, 8),
    };
    Style { wall: wall.shaded(shade).of_kind(kind), roof: roof.shaded(shade), window_m, storey_m }
}

/// Size that a building is dropped by: the diagonal of its box.
pub fn size_m(solid: &BuildingSolid, top_m: f64) -> f64 {
    let around = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (low, high) = solid.outline.iter().fold(around, |(low, high), at| (low.min(*at), high.max(*at)));
    (high - low).extend(top_m - solid.base_m).length()
}

/// Adds a building to a mesh whose x and z count from a plan point and whose y is above sea level.
pub fn add(mesh: &mut Mesh, solid: &BuildingSolid, class: BuildingClass, from: DVec2, size_m: f64) {
    let hash = hash_of(solid.outline[0]);
    // What is large, low and of no stated use is a hall.
    let hall = class == BuildingClass::Other
        && solid.eaves_m - solid.base_m < 12.0
        && doubled_area_m2(&solid.outline) > 2.0 * HALL_M2;
    let style = style(if hall { BuildingClass::Industrial } else { class }, solid.roof, hash);
    mesh.seed = (hash << 8) | size_code(size_m as f32);
    let point = |at: DVec2, y_m: f64| DVec3::new(at.x - from.x, y_m, at.y - from.y).as_vec3();
    let (height_m, foot_m) = (solid.eaves_m - solid.base_m, solid.base_m - FOOT_M);
    let storeys = (height_m / style.storey_m).round().max(1.0);
    let foot = -(FOOT_M / height_m * storeys) as f32;
    for (a, b) in pairs(&solid.outline) {
        let long_m = a.distance(b);
        // A wall too short for a window has none.
        let windows = (long_m / style.window_m).round() as f32;
        let paint = if windows < 1.0 { style.wall.of_kind(0) } else { style.wall };
        let top = storeys as f32;
        let corners = [point(a, foot_m), point(b, foot_m), point(b, solid.eaves_m), point(a, solid.eaves_m)];
        let facade = [Vec2::new(0.0, foot), Vec2::new(windows, foot), Vec2::new(windows, top), Vec2::new(0.0, top)];
        mesh.facade(&corners, &facade, paint);
        let profile = solid.wall_top(a, b);
        if profile.iter().any(|(_, y_m)| *y_m > solid.eaves_m + 0.01) {
            let mut gable = vec![point(a, solid.eaves_m), point(b, solid.eaves_m)];
            gable.extend(profile.iter().rev().map(|(fraction, y_m)| point(a.lerp(b, *fraction), *y_m)));
            gable.dedup_by(|a, b| a.distance_squared(*b) < 1e-6);
            mesh.face(&gable, style.wall.of_kind(0));
        }
    }
    for (plane, piece) in solid.roof_pieces() {
        let plane = &solid.planes[plane];
        let mut indices = triangulated(&piece);
        let corners: Vec<Vec3> = piece.iter().map(|at| point(*at, plane.height_m(*at))).collect();
        for triangle in indices.chunks_exact_mut(3) {
            let [a, b, c] = [triangle[0], triangle[1], triangle[2]].map(|index| corners[index as usize]);
            if (b - a).cross(c - a).y < 0.0 {
                triangle.swap(1, 2);
            }
        }
        mesh.triangles(&corners, &indices, plane.normal().as_vec3(), style.roof);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrain::features::model::{Building, Origin};

    #[test]
    fn drawn_faces_lie_on_the_solid_and_look_outward() {
        use BuildingClass as C;
        let ell = [(0.0, 0.0), (14.0, 0.0), (14.0, 7.0), (6.0, 7.0), (6.0, 13.0), (0.0, 13.0)];
        for class in [C::House, C::Apartments, C::Commercial, C::Industrial, C::Church, C::Hangar, C::Barn, C::Other] {
            for turn in [0.0, 0.4, 2.0] {
                for corners in [&ell[..], &ell[..4]] {
                    let turn = DVec2::from_angle(turn);
                    let outline =
                        corners.iter().map(|(x, z)| turn.rotate(DVec2::new(*x, *z)) + DVec2::new(7e4, -3e4)).collect();
                    let building = Building { class, outline, height_m: 8.0, height_from: Origin::Stated };
                    let solid = BuildingSolid::new(&building, [700.0; 2]);
                    let from = DVec2::new(69_900.0, -30_150.0);
                    let mut mesh = Mesh::default();
                    add(&mut mesh, &solid, class, from, 20.0);
                    for triangle in mesh.indices.chunks_exact(3) {
                        let at =
                            [0, 1, 2].map(|n| Vec3::from(mesh.vertices[triangle[n] as usize].position_m).as_dvec3());
                        let normal = (at[1] - at[0]).cross(at[2] - at[0]);
                        if normal.length() < 1e-2 {
                            continue;
                        }
                        let normal = normal.normalize();
                        let middle = (at[0] + at[1] + at[2]) / 3.0 + DVec3::new(from.x, 0.0, from.y);
                        // Inside on one side, outside on the other: f32 local coordinates are good to 0.1 mm.
                        assert!(solid.contains(middle - normal * 1e-3), "{class:?} {middle} {normal}");
                        assert!(!solid.contains(middle + normal * 1e-3), "{class:?} {middle} {normal}");
                    }
                }
            }
        }
    }
}
