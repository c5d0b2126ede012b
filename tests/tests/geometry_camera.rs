//! The camera against Mitsuba 3 and against itself.

use renderers::geometry::glam::{DAffine3, DMat3, DVec3, Vec3A};
use renderers::geometry::{Camera, FovAxis, GeometryError};

/// Mitsuba's `look_at`: +z to the target, +x to the left of the picture.
fn look_at(origin: DVec3, target: DVec3, up: DVec3) -> DAffine3 {
    let z = (target - origin).normalize();
    let x = up.cross(z).normalize();
    DAffine3::from_mat3_translation(DMat3::from_cols(x, z.cross(x), z), origin)
}

fn oblique() -> DAffine3 {
    look_at(DVec3::new(3.0, -2.0, 5.0), DVec3::new(0.0, 1.0, 0.5), DVec3::Z)
}

type Case = (DAffine3, f64, FovAxis, [u32; 2], [([f32; 2], [f32; 3]); 2]);

/// Independent: directions of `sensor.sample_ray_differential` of Mitsuba 3.9.1, variant `scalar_rgb`, for a sensor made
/// by `look_at`; its own arithmetic is `f32`.
fn cases() -> Vec<Case> {
    let cornell = look_at(DVec3::new(278.0, 273.0, -800.0), DVec3::new(278.0, 273.0, 0.0), DVec3::Y);
    vec![
        (
            cornell,
            39.3077,
            FovAxis::Smaller,
            [256, 256],
            [
                ([0.0, 0.0], [0.318_788_74, 0.318_788_74, 0.892_607_15]),
                ([64.0, 192.0], [0.173_136_1, -0.173_136_04, 0.969_560_7]),
            ],
        ),
        (
            oblique(),
            50.0,
            FovAxis::X,
            [640, 360],
            [
                ([0.0, 0.0], [-0.837_430_2, 0.255_961_9, -0.482_901_93]),
                ([448.3, 359.4], [-0.207_895_52, 0.459_615_65, -0.863_442_5]),
            ],
        ),
        (
            oblique(),
            50.0,
            FovAxis::Y,
            [640, 360],
            [
                ([160.0, 270.0], [-0.594_412_5, 0.065_041_386, -0.801_525_8]),
                ([640.0, 180.0], [0.077_843_88, 0.824_720_56, -0.560_157_5]),
            ],
        ),
        (
            oblique(),
            50.0,
            FovAxis::Larger,
            [360, 640],
            [
                ([0.0, 0.0], [-0.802_782_83, 0.475_706_9, -0.359_503_45]),
                ([252.3, 639.4], [-0.154_427_04, 0.288_896_8, -0.944_823_2]),
            ],
        ),
        (
            oblique(),
            50.0,
            FovAxis::Smaller,
            [360, 640],
            [
                ([90.0, 480.0], [-0.394_355_77, 0.096_584_52, -0.913_868_2]),
                ([252.3, 639.4], [0.055_729_363, 0.146_257_3, -0.987_675_67]),
            ],
        ),
        (
            oblique(),
            50.0,
            FovAxis::Diagonal,
            [640, 360],
            [
                ([0.0, 0.0], [-0.806_682_35, 0.285_765_6, -0.517_302_33]),
                ([640.0, 180.0], [-0.183_139_73, 0.715_611, -0.674_062_97]),
            ],
        ),
    ]
}

#[test]
fn rays_are_those_of_mitsuba() {
    for (to_world, fov, axis, [width, height], rays) in cases() {
        let camera = Camera::new(&to_world, fov, axis, width, height).unwrap();
        for ([x, y], expected) in rays {
            let ray = camera.ray(x, y);
            let error = (ray.direction - Vec3A::from_array(expected)).abs().max_element();
            assert!(error <= 1e-6, "{axis:?} {x} {y}: {:?}, {error}", ray.direction);
            assert_eq!(ray.origin, to_world.translation.as_vec3a());
        }
    }
}

#[test]
fn projection_inverts_rays() {
    for (to_world, fov, axis, [width, height], rays) in cases() {
        let camera = Camera::new(&to_world, fov, axis, width, height).unwrap();
        assert_eq!(camera.size(), [width, height]);
        for ([x, y], _) in rays {
            for distance in [0.1, 1.0, 1e3] {
                // In units of the distance, the point is rounded to the size of its coordinates.
                let point = camera.ray(x, y).at(distance);
                let [px, py] = camera.project(point).unwrap();
                let rounding = (point.abs().max_element() + 1.0) / distance * f32::EPSILON;
                let tolerance = 1e-4 + 2e3 * rounding;
                assert!((px - x).abs() <= tolerance && (py - y).abs() <= tolerance, "{px} {py}: {x} {y}");
            }
            assert_eq!(camera.project(camera.ray(x, y).at(-1.0)), None);
        }
    }
}

#[test]
fn the_x_axis_is_left_and_a_mirrored_camera_swaps_sides() {
    let straight = Camera::new(&DAffine3::IDENTITY, 60.0, FovAxis::X, 100, 50).unwrap();
    assert!(straight.ray(0.0, 25.0).direction.x > 0.4 && straight.ray(50.0, 0.0).direction.y > 0.2);
    let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let mirrored = Camera::new(&mirror, 60.0, FovAxis::X, 100, 50).unwrap();
    assert!(mirrored.ray(0.0, 25.0).direction.x < -0.4);
}

#[test]
fn bad_cameras_are_refused() {
    let camera = |to_world: DAffine3, fov: f64, width: u32| Camera::new(&to_world, fov, FovAxis::X, width, 2).err();
    let good = DAffine3::IDENTITY;
    assert_eq!(camera(good, 40.0, 2), None);
    assert_eq!(camera(good, 40.0, 0), Some(GeometryError::BadImageSize));
    assert_eq!(camera(good, 40.0, u32::MAX), Some(GeometryError::BadImageSize));
    for fov in [0.0, 180.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(camera(good, fov, 2), Some(GeometryError::BadFieldOfView));
    }
    for bad in [
        DAffine3::from_scale(DVec3::splat(2.0)),
        DAffine3::from_scale(DVec3::splat(f64::NAN)),
        DAffine3::from_translation(DVec3::splat(f64::INFINITY)),
        DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::new(0.6, 0.8, 0.0), DVec3::Z)),
        DAffine3::ZERO,
    ] {
        assert_eq!(camera(bad, 40.0, 2), Some(GeometryError::BadCameraTransform));
    }
}
