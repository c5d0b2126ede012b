//! Visible configuration factors against closed forms, against sums over dense points, and where surfaces touch.
#![allow(clippy::panic, clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use core::f64::consts::PI;

use renderers::direct::{
    Blockers, Estimate, Flat, Receiver, Scratch, Shape, Source, Surroundings, Way, sources,
    visible_configuration_factor, world,
};
use renderers::geometry::glam::{DQuat, DVec3};
use renderers::geometry::{NO_PRIMITIVE, World};
use renderers::scene::{Scene, load};
use spectral_tests::statistics::Rng;

/// A scene of which the first shape is the light.
struct Setting {
    scene: Scene,
    world: World,
    blockers: Blockers,
    sources: Vec<Source>,
}

impl Setting {
    fn new(shapes: &str) -> Self {
        Self::with_mesh(shapes, String::new())
    }

    /// The same with a mesh, `mesh.obj`.
    fn with_mesh(shapes: &str, mesh: String) -> Self {
        let xml = format!(
            "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='40'/></sensor>{shapes}</scene>"
        );
        let scene = load(&renderers::scene::Source::text("test.xml", xml).with_asset("mesh.obj", mesh), &[]).unwrap();
        let (world, blockers) = (world(&scene).unwrap(), Blockers::new(&scene));
        let sources = sources(&scene.shapes[0], 0).unwrap();
        Self { scene, world, blockers, sources }
    }

    fn around(&self) -> Surroundings<'_> {
        Surroundings { world: &self.world, blockers: &self.blockers }
    }

    fn receiver(&self, position: DVec3, normal: DVec3) -> Receiver {
        Receiver::new(position, normal.normalize(), &self.world)
    }

    /// The sum over the light's sources.
    fn see(&self, receiver: &Receiver, accuracy: f64) -> Estimate {
        let mut scratch = Scratch::default();
        self.sources.iter().fold(Estimate::NOTHING, |sum, source| {
            let found = visible_configuration_factor(source, self.around(), receiver, accuracy, &mut scratch);
            Estimate {
                factor: sum.factor + found.factor,
                error: sum.error + found.error,
                rays: sum.rays + found.rays,
                way: if found.way == Way::Unblocked { sum.way } else { found.way },
            }
        })
    }

    fn at(&self, position: [f64; 3], normal: [f64; 3]) -> Estimate {
        self.see(&self.receiver(DVec3::from(position), DVec3::from(normal)), 1e-3)
    }
}

const MESH: &str = "<shape type='obj'><string name='filename' value='mesh.obj'/></shape>";

fn shape(kind: &str, transform: &str) -> String {
    format!("<shape type='{kind}'><transform name='to_world'>{transform}</transform></shape>")
}

/// A rectangle from (x1, y1) to (x2, y2) at a height z, seen from below or from above.
fn level(z: f64, [x1, x2]: [f64; 2], [y1, y2]: [f64; 2], down: bool) -> String {
    let turn = if down { "<rotate x='1' angle='180'/>" } else { "" };
    let (x, y) = ((x1 + x2) / 2.0, (y1 + y2) / 2.0);
    let (w, h) = ((x2 - x1) / 2.0, (y2 - y1) / 2.0);
    shape("rectangle", &format!("{turn}<scale x='{w}' y='{h}'/><translate x='{x}' y='{y}' z='{z}'/>"))
}

#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, expected {expected} within {tolerance}");
}

/// Element below the corner of a parallel rectangle a × b at distance c (Howell's catalogue, B-3), added up to any rectangle.
fn parallel(c: f64, [x1, x2]: [f64; 2], [y1, y2]: [f64; 2]) -> f64 {
    let corner = |a: f64, b: f64| {
        let (p, q) = (c.hypot(a), c.hypot(b));
        (a / p * (b / p).atan() + b / q * (a / q).atan()) / (2.0 * PI)
    };
    corner(x2, y2) - corner(x1, y2) - corner(x2, y1) + corner(x1, y1)
}

/// Element at a distance c from a rectangle in a plane perpendicular to its own, opposite a corner on its own plane; the rectangle is a wide
/// and b high (Howell's catalogue, B-4).
fn perpendicular(c: f64, a: f64, b: f64) -> f64 {
    let q = b.hypot(c);
    ((a / c).atan() - c / q * (a / q).atan()) / (2.0 * PI)
}

/// `independent`: the catalogue's closed forms.
#[test]
fn whole_lights_are_their_closed_forms() {
    let up = [0.0, 0.0, 1.0];
    let rectangle = Setting::new(&level(2.0, [-1.5, 1.5], [-0.75, 0.75], true));
    for x in [0.0, 1.5, 7.0] {
        let expected = parallel(2.0, [-1.5 - x, 1.5 - x], [-0.75, 0.75]);
        assert_near(rectangle.at([x, 0.0, 0.0], up).factor, expected, 1e-14);
    }
    let wall =
        Setting::new(&shape("rectangle", "<rotate y='1' angle='90'/><scale y='1.5' z='2'/><translate x='-1' z='2'/>"));
    let expected = 2.0 * perpendicular(1.0, 1.5, 4.0);
    assert_near(wall.at([0.0, 0.0, 0.0], up).factor, expected, 1e-14);
    for (r, h) in [(0.4, 3.55), (1.0, 1.0), (1.0, 0.01), (3.0, 1000.0_f64)] {
        let disk = shape("disk", &format!("<rotate x='1' angle='180'/><scale value='{r}'/><translate z='{h}'/>"));
        let disk = Setting::new(&disk);
        for x in [0.0, 0.5, 0.99, 1.0, 1.01, 3.0_f64] {
            // Hamilton and Morgan 1952, parallel; B-12 in Howell's catalogue.
            let (sum, root) = (h * h + x * x, (h * h + (x - r) * (x - r)).sqrt() * (h * h + (x + r) * (x + r)).sqrt());
            assert_near(disk.at([x, 0.0, 0.0], up).factor, 0.5 * (1.0 - (sum - r * r) / root), 4e-14);
        }
    }
    let ball = Setting::new(
        "<shape type='sphere'><point name='center' value='0 0 2'/><float name='radius' value='0.5'/></shape>",
    );
    for x in [0.0_f64, 1.0, 4.0] {
        let distance = x.hypot(2.0);
        assert_near(ball.at([x, 0.0, 0.0], up).factor, (0.5 / distance).powi(2) * (2.0 / distance), 1e-15);
    }
    // Half above the horizon: a sphere in the receiver's plane (Howell's catalogue, B-43): [asin s... ] by its special case at ω = 90°.
    let (r, d) = (0.5_f64, 2.0_f64);
    let s = r / d;
    let expected = (s.asin() - s * (1.0 - s * s).sqrt()) / PI;
    assert_near(ball.at([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]).factor, expected, 1e-15);
}

/// A light half behind the straight edge of a large screen is the closed form of its other half.
#[test]
fn half_hidden_lights_are_closed_forms_of_the_rest() {
    let light = level(2.0, [-1.0, 1.0], [-1.0, 1.0], true);
    for (z, x, edge) in [(1.0, 0.0, 0.0), (1.0, 0.3, 0.1), (1.999, -3.0, 0.3), (1e-3, 0.0, 1e-4), (0.5, 20.0, 14.9)] {
        let screen = Setting::new(&(light.clone() + &level(z, [edge - 100.0, edge], [-100.0, 100.0], false)));
        // Where the edge's shadow falls on the light.
        let shadow = (x + (edge - x) * 2.0 / z).clamp(-1.0, 1.0);
        let expected = parallel(2.0, [shadow - x, 1.0 - x], [-1.0, 1.0]);
        let found = screen.at([x, 0.0, 0.0], [0.0, 0.0, 1.0]);
        // The screen's edge is rounded as coordinates of 100 are, and its shadow moves by as much times 2/z.
        assert_near(found.factor, expected, 1e-14 + 100.0 * f64::EPSILON * 2.0 / z);
        assert!(found.error <= 1e-12, "{found:?}");
    }
}

/// A window in a wall of four rectangles, and a small screen before a light: closed forms of what is left.
#[test]
fn windows_and_screens_add_up() {
    let light = level(4.0, [-3.0, 3.0], [-3.0, 3.0], true);
    let wall = level(1.0, [-50.0, -0.5], [-50.0, 50.0], false)
        + &level(1.0, [0.25, 50.0], [-50.0, 50.0], true)
        + &level(1.0, [-0.5, 0.25], [-50.0, -0.25], false)
        + &level(1.0, [-0.5, 0.25], [0.5, 50.0], false);
    let screen = level(1.0, [-0.5, 0.25], [-0.25, 0.5], false);
    let window = Setting::new(&(light.clone() + &wall));
    let screened = Setting::new(&(light.clone() + &screen));
    let closed = Setting::new(&(light.clone() + &wall + &screen));
    let whole = Setting::new(&light);
    for (x, y, normal) in [(0.0, 0.0, [0.0, 0.0, 1.0]), (0.2, -0.1, [0.6, 0.0, 0.8]), (-0.3, 0.1, [0.0, 0.99, 0.1])] {
        let at = |setting: &Setting| setting.at([x, y, 0.0], normal).factor;
        assert_near(at(&window) + at(&screened), at(&whole), 1e-14);
        assert_eq!(at(&closed), 0.0);
        if normal[2] == 1.0 {
            let expected = parallel(4.0, [-2.0 - 3.0 * x, 1.0 - 3.0 * x], [-1.0 - 3.0 * y, 2.0 - 3.0 * y]);
            assert!(expected > 0.0);
            let clip = |low: f64, high: f64, from: f64| {
                [(from + 4.0 * (low - from)).max(-3.0) - from, (from + 4.0 * (high - from)).min(3.0) - from]
            };
            assert_near(at(&window), parallel(4.0, clip(-0.5, 0.25, x), clip(-0.25, 0.5, y)), 1e-14);
        }
    }
}

/// A closed wall, however it is tessellated and turned, lets exactly nothing through, to any receiver and any kind of light.
#[test]
fn tessellated_walls_are_tight() {
    let mut rng = Rng::new(7);
    for case in 0..60 {
        let turn = DQuat::from_axis_angle(DVec3::from_array(rng.direction()), 3.0 * rng.unit());
        let count = 2 + usize::try_from(rng.bits() % 7).unwrap();
        let mesh = wall(&mut rng, turn, count);
        let lamp = turn * DVec3::new(0.2, -0.1, 2.0);
        let (axis, angle) = turn.to_axis_angle();
        let place = format!(
            "<scale value='0.7'/><rotate x='{}' y='{}' z='{}' angle='{}'/><translate x='{}' y='{}' z='{}'/>",
            axis.x,
            axis.y,
            axis.z,
            angle.to_degrees(),
            lamp.x,
            lamp.y,
            lamp.z
        );
        let flip = "<boolean name='flip_normals' value='true'/>";
        let light = ["rectangle", "disk", "sphere"][case % 3];
        let flip = if light == "sphere" { "" } else { flip };
        let light = format!("<shape type='{light}'>{flip}<transform name='to_world'>{place}</transform></shape>");
        let setting = Setting::with_mesh(&(light.clone() + MESH), mesh);
        for _ in 0..20 {
            let place = DVec3::new(2.0 * rng.unit() - 1.0, 2.0 * rng.unit() - 1.0, -1.5 * rng.unit() - 0.2);
            let receiver = setting.receiver(turn * place, turn * (DVec3::Z + 0.5 * DVec3::from_array(rng.direction())));
            let found = setting.see(&receiver, 1e-3);
            assert!(found.factor == 0.0 && found.way == Way::Exact, "{case} {light} {place}: {found:?}");
        }
    }
}

/// A wavy wall of count² fields of two triangles each, as OBJ.
fn wall(rng: &mut Rng, turn: DQuat, count: usize) -> String {
    use core::fmt::Write as _;
    let mut text = String::new();
    #[allow(clippy::cast_precision_loss, reason = "small numbers")]
    for (i, j) in (0..=count).flat_map(|i| (0..=count).map(move |j| (i, j))) {
        let inner = |k: usize| k > 0 && k < count;
        let jitter = if inner(i) && inner(j) { 0.3 } else { 0.0 };
        let along = |k: usize, r: f64| 40.0 * ((k as f64 + jitter * (r - 0.5)) / count as f64 - 0.5);
        let (x, y) = (along(i, rng.unit()), along(j, rng.unit()));
        let v = turn * DVec3::new(x, y, 0.1 * jitter * rng.unit());
        writeln!(text, "v {} {} {}", v.x, v.y, v.z).unwrap();
    }
    for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
        let v = |di: usize, dj: usize| (i + di) * (count + 1) + j + dj + 1;
        let (a, b, c, d) = (v(0, 0), v(1, 0), v(1, 1), v(0, 1));
        if rng.bits().is_multiple_of(2) {
            writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
        } else {
            writeln!(text, "f {a} {b} {d}\nf {c} {b} {d}").unwrap();
        }
    }
    text
}

/// Whether the way from a point to another meets a triangle, in f64.
fn meets(from: DVec3, to: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let way = to - from;
    let (u, v) = (b - a, c - a);
    let p = way.cross(v);
    let determinant = u.dot(p);
    let s = from - a;
    let (x, q) = (s.dot(p) / determinant, s.cross(u));
    let (y, t) = (way.dot(q) / determinant, v.dot(q) / determinant);
    x >= 0.0 && y >= 0.0 && x + y <= 1.0 && t > 0.0 && t < 1.0
}

/// Whether the way meets a sphere.
fn meets_sphere(from: DVec3, to: DVec3, centre: DVec3, radius: f64) -> bool {
    let way = to - from;
    let t = ((centre - from).dot(way) / way.length_squared()).clamp(0.0, 1.0);
    (from + way * t).distance(centre) < radius
}

/// The light's points for a square's, area for area, and its normal and area.
fn sample(shape: &Shape, [x, y]: [f64; 2]) -> (DVec3, DVec3, f64) {
    match *shape {
        Shape::Rectangle(flat) => {
            (flat.at([2.0 * x - 1.0, 2.0 * y - 1.0]), flat.normal, 4.0 * flat.u.cross(flat.v).length())
        }
        Shape::Disk(flat) => {
            let (sin, cos) = (2.0 * PI * y).sin_cos();
            (flat.at([x.sqrt() * cos, x.sqrt() * sin]), flat.normal, PI * flat.u.length_squared())
        }
        _ => panic!("not sampled"),
    }
}

/// The visible factor by the midpoints of a fine grid.
fn by_points(source: &Source, receiver: &Receiver, visible: impl Fn(DVec3) -> bool) -> f64 {
    const SIDE: u32 = 600;
    let mut sum = 0.0;
    for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
        let (point, normal, area) = sample(&source.shape, [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(SIDE)));
        let way = point - receiver.position;
        let cosines = way.dot(receiver.normal).max(0.0) * (-way.dot(normal)).max(0.0);
        if cosines > 0.0 && visible(point) {
            sum += cosines / way.length_squared().powi(2) * area;
        }
    }
    sum / (PI * f64::from(SIDE * SIDE))
}

/// `independent`: dense points and a plain intersection in f64, for random triangles that overlap, pierce each other and the light.
#[test]
fn random_triangles_hide_what_points_say() {
    let mut rng = Rng::new(11);
    let mut partly = 0;
    for case in 0..40 {
        let kind = ["rectangle", "disk"][case % 2];
        let vertices: Vec<DVec3> = (0..3 * (1 + case % 6))
            .map(|_| {
                let direction = DVec3::from_array(rng.direction());
                DVec3::new(0.0, 0.0, 1.2) + direction * (1.3 * rng.unit())
            })
            .collect();
        let mut text: String = vertices.iter().map(|v| format!("v {} {} {}\n", v.x, v.y, v.z)).collect();
        text.extend((0..vertices.len() / 3).map(|i| format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3)));
        let light = shape(kind, "<rotate x='1' angle='180'/><translate z='2'/>");
        let setting = Setting::with_mesh(&(light + MESH), text);
        let receiver = setting.receiver(
            DVec3::new(rng.unit() - 0.5, rng.unit() - 0.5, 0.0),
            (DVec3::Z + 0.8 * DVec3::from_array(rng.direction())).normalize(),
        );
        let found = setting.see(&receiver, 1e-3);
        let triangles: Vec<[DVec3; 3]> = vertices.chunks(3).map(|v| [v[0], v[1], v[2]]).collect();
        let visible = |point| !triangles.iter().any(|t| meets(receiver.position, point, *t));
        let expected = by_points(&setting.sources[0], &receiver, visible);
        let whole = by_points(&setting.sources[0], &receiver, |_| true);
        partly += u32::from(expected > 0.05 * whole && expected < 0.95 * whole);
        // An edge through the grid leaves out or adds parts of the cells it passes, which mostly cancel.
        assert!(found.rays == 0, "{case}: {found:?}");
        assert_near(found.factor, expected, 4e-4 * whole + found.error);
    }
    assert!(partly >= 15, "{partly}");
}

/// Round blockers are taken between polygons: the bound holds, and is as asked for.
#[test]
fn round_blockers_are_bounded() {
    let mut rng = Rng::new(5);
    for case in 0..24 {
        let kind = ["rectangle", "disk"][case % 2];
        let centre = DVec3::new(rng.unit() - 0.5, rng.unit() - 0.5, 0.6 + 0.6 * rng.unit());
        let radius = 0.1 + 0.3 * rng.unit();
        let setting = Setting::new(&format!(
            "{}<shape type='sphere'><point name='center' value='{} {} {}'/><float name='radius' value='{radius}'/></shape>",
            shape(kind, "<rotate x='1' angle='180'/><translate z='2'/>"),
            centre.x,
            centre.y,
            centre.z
        ));
        let receiver = setting.receiver(DVec3::ZERO, DVec3::new(0.3 * rng.unit(), 0.0, 1.0).normalize());
        let expected = by_points(&setting.sources[0], &receiver, |p| !meets_sphere(DVec3::ZERO, p, centre, radius));
        for accuracy in [1e-2, 1e-3, 1e-4] {
            let found = setting.see(&receiver, accuracy);
            assert!(found.rays == 0 && found.error <= accuracy * found.factor, "{case}: {found:?}");
            assert_near(found.factor, expected, 3e-4 * expected + found.error);
        }
    }
}

/// On the axis of a ball before a disk, the visible part is the difference of two disks.
#[test]
fn a_ball_on_the_axis_is_a_difference_of_disks() {
    let (h, d, r) = (2.0_f64, 1.0_f64, 0.25_f64);
    let setting = Setting::new(&format!(
        "{}<shape type='sphere'><point name='center' value='0 0 {d}'/><float name='radius' value='{r}'/></shape>",
        shape("disk", &format!("<rotate x='1' angle='180'/><translate z='{h}'/>"))
    ));
    let expected = 1.0 / (1.0 + h * h) - (r / d).powi(2);
    for accuracy in [1e-2, 1e-3, 1e-4] {
        let found = setting.see(&setting.receiver(DVec3::ZERO, DVec3::Z), accuracy);
        assert!(found.way == Way::Bounded && found.error <= accuracy * expected, "{found:?}");
        assert_near(found.factor, expected, 0.1 * found.error);
    }
}

/// Whatever touches the receiver or the light hides nothing by touching.
#[test]
fn contact_does_not_hide() {
    let light = level(2.0, [-1.0, 1.0], [-1.0, 1.0], true);
    let expected = parallel(2.0, [-1.0, 1.0], [-1.0, 1.0]);
    let up = [0.0, 0.0, 1.0];
    // On a floor, and on one whose coordinates are rounded; under a ceiling that the light is let into; a lid right behind the light.
    let floor = level(0.0, [-5.0, 5.0], [-5.0, 5.0], false);
    let frame = level(2.0, [1.0, 5.0], [-5.0, 5.0], true) + &level(2.0, [-5.0, -1.0], [-5.0, 5.0], true);
    for around in [floor.clone(), frame.clone(), floor + &frame, level(2.0 + 1e-7, [-5.0, 5.0], [-5.0, 5.0], true)] {
        assert_near(Setting::new(&(light.clone() + &around)).at([0.0; 3], up).factor, expected, 1e-14);
    }
    // A wall on the light's edge: it hides what is behind it, all or nothing.
    let wall = shape("rectangle", "<rotate y='1' angle='90'/><scale y='5'/><translate x='1' z='1'/>");
    let walled = Setting::new(&(light.clone() + &wall));
    let free = parallel(2.0, [-1.5, 0.5], [-1.0, 1.0]);
    assert_near(walled.at([0.5, 0.0, 0.0], up).factor, free, 1e-14);
    assert_eq!(walled.at([1.5, 0.0, 0.0], up).factor, 0.0);
    // In the light's own plane, behind it, and below the horizon.
    let alone = Setting::new(&light);
    for (position, normal) in
        [([3.0, 0.0, 2.0], [-1.0, 0.0, 0.0]), ([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]), ([0.0; 3], [0.0, 0.0, -1.0])]
    {
        assert_eq!(alone.at(position, normal).factor, 0.0);
    }
    // Nearly on the light: it fills the hemisphere.
    assert_near(alone.at([0.0, 0.0, 2.0 - 1e-6], up).factor, 1.0, 1e-11);
}

/// `published` geometry: CIE 171:2006, test case 5.7: a vertical source behind an obstruction, seen from a vertical wall. The shadow's edge is a
/// straight line, so the visible part is a rectangle of its own.
#[test]
fn light_over_an_obstruction() {
    // A source 4 wide and 3 high at x = 4; a box 1 high from x = 2.5 to 2.7, wider than everything; receivers at x = 0.
    let source = shape("rectangle", "<rotate y='1' angle='-90'/><scale y='2' z='1.5'/><translate x='4' z='1.5'/>");
    let block = shape("cube", "<scale x='0.1' y='50' z='0.5'/><translate x='2.6' z='0.5'/>");
    let setting = Setting::new(&(source + &block));
    for z in [0.0, 0.25, 0.5, 0.9, 1.0, 1.1, 2.0, 3.0] {
        let over = |x: f64| z + (1.0 - z) * 4.0 / x;
        let lowest = over(2.5).max(over(2.7)).clamp(0.0, 3.0);
        let lowest = if lowest.is_nan() { 0.0 } else { lowest };
        let expected = parallel(4.0, [-2.0, 2.0], [lowest - z, 3.0 - z]);
        let found = setting.at([0.0, 0.0, z], [1.0, 0.0, 0.0]);
        assert_near(found.factor, expected, 1e-13);
    }
    // Points on the floor before the obstruction, facing up.
    for x in [0.0, 0.5, 1.0, 2.0, 2.4_f64] {
        let lowest = ((4.0 - x) / (2.5 - x)).max((4.0 - x) / (2.7 - x)).min(3.0);
        let (near, d) = (lowest, 4.0 - x);
        let expected = 2.0 * (perpendicular(d, 2.0, 3.0) - perpendicular(d, 2.0, near));
        assert_near(setting.at([x, 0.0, 0.0], [0.0, 0.0, 1.0]).factor, expected, 1e-13);
    }
    assert_eq!(setting.scene.shapes.len(), 2);
}

/// Where too much is in the way for closed forms, shadow rays estimate the visible share: the stated error holds.
#[test]
fn shadow_rays_say_how_far_they_are_off() {
    // A comb of 400 strips between the light and a receiver, and a solid screen of the same width.
    let light = level(2.0, [-1.0, 1.0], [-1.0, 1.0], true);
    let strips: String = (0..400)
        .map(|i| {
            let x = -0.4 + 0.002 * f64::from(i);
            level(1.0, [x, x + 0.002], [-0.3, 0.2], false)
        })
        .collect();
    let many = Setting::new(&(light.clone() + &strips));
    let one = Setting::new(&(light + &level(1.0, [-0.4, 0.4], [-0.3, 0.2], false)));
    let (mut outside, mut all) = (0, 0);
    for (i, j) in (-3..=3).flat_map(|i| (-3..=3).map(move |j| (i, j))) {
        let receiver = one
            .receiver(DVec3::new(0.17 * f64::from(i), 0.17 * f64::from(j), 0.0), DVec3::new(0.1, 0.2, 1.0).normalize());
        let expected = one.see(&receiver, 1e-3);
        for accuracy in [1e-2, 1e-3] {
            let found = many.see(&receiver, accuracy);
            assert!(
                found.way == Way::Sampled && found.error <= (1.0 + 2.0 * accuracy) * accuracy * found.factor,
                "{found:?}"
            );
            all += 1;
            outside += i32::from(!((found.factor - expected.factor).abs() <= found.error + expected.error));
        }
    }
    assert!(outside <= all / 100, "{outside} of {all}");
}

/// `independent`: the closed forms of disks and spheres in `disk-sampling`, by other formulae, for receivers that see them cut by their
/// horizon, from nearby and from afar.
#[test]
fn round_lights_agree_with_their_closed_forms() {
    let mut rng = Rng::new(3);
    let mut cut = 0;
    for case in 0..4000 {
        let size = 10.0_f64.powf(3.0 * rng.unit() - 2.0);
        let (axis, tilt) = (DVec3::from_array(rng.direction()), DVec3::from_array(rng.direction()));
        let position = DVec3::from_array(rng.direction()) * (0.05 + 2.0 * rng.unit());
        let (u, v) = axis.any_orthonormal_pair();
        let flat = Flat { centre: DVec3::ZERO, u: u * size, v: v * size, normal: axis };
        let disk = disk_sampling::Disk::new([0.0; 3], axis.to_array(), size).unwrap();
        let sphere = disk_sampling::Sphere::new([0.0; 3], size).unwrap();
        let element = disk_sampling::Receiver::new(position.to_array(), tilt.to_array()).unwrap();
        let (shape, expected) = if case % 2 == 0 {
            (Shape::Disk(flat), disk_sampling::disk_configuration_factor(&disk, &element))
        } else if position.length() > size {
            let centre = DVec3::ZERO;
            (Shape::Sphere { centre, radius: size }, disk_sampling::sphere_configuration_factor(&sphere, &element))
        } else {
            continue;
        };
        let world = World::new(&[]).unwrap();
        let blockers = Blockers::default();
        let around = Surroundings { world: &world, blockers: &blockers };
        let receiver = Receiver::new(position, tilt, &world);
        let source = Source { shape, primitive: NO_PRIMITIVE };
        let found = visible_configuration_factor(&source, around, &receiver, 1e-3, &mut Scratch::default());
        let height = -position.dot(tilt);
        cut += u32::from(height.abs() < size && expected > 0.0);
        assert_near(found.factor, expected, 1e-13 + found.error);
    }
    assert!(cut > 500, "{cut}");
}

/// A receiver whose shading normal leans away from its surface sees nothing below that surface: by shadow rays as by closed forms.
#[test]
fn nothing_comes_from_below_the_surface() {
    let light = level(2.0, [-1.0, 1.0], [-1.0, 1.0], true);
    let strips: String = (0..400)
        .map(|i| {
            let x = 5.0 + 0.002 * f64::from(i);
            level(1.0, [x, x + 0.002], [-0.3, 0.2], false)
        })
        .collect();
    let far = level(1.0, [0.3, 0.8], [-0.3, 0.2], false);
    let many = level(1.0, [0.3, 0.8], [-0.3, 0.2], false) + &strips;
    for (nx, gx) in [(0.3, -0.2), (0.0, 0.9), (0.5, 0.0), (-0.4, 0.95)] {
        let unit = |x: f64| DVec3::new(x, 0.0, (1.0 - x * x).sqrt());
        for setting in [Setting::new(&(light.clone() + &far)), Setting::new(&(light.clone() + &many))] {
            let receiver = Receiver { geometric: unit(gx), ..setting.receiver(DVec3::ZERO, unit(nx)) };
            let triangles =
                |p: DVec3| p.dot(unit(gx)) > 0.0 && !(0.6..=1.6).contains(&p.x) | !(-0.6..=0.4).contains(&p.y);
            let expected = by_points(&setting.sources[0], &receiver, triangles);
            let found = setting.see(&receiver, 1e-3);
            assert_near(found.factor, expected, 2e-3 * expected.max(0.01) + found.error);
        }
    }
}
