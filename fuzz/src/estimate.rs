//! Illuminance under a disk by few samples.

use disk_sampling::estimate::{Aim, Panel, Request, Response, Status, integrate, ratio};
use disk_sampling::{Disk, Receiver, disk_configuration_factor};
use spectral_core::Real;

use crate::numbers::{Numbers, assert_in};

/// Estimates a factor for emission and shadows made of the bytes: uniform light is exact, and nothing that is asked for is
/// infinite.
pub fn estimate(bytes: &[u8]) {
    check::<f64>(&mut Numbers::new(bytes));
    check::<f32>(&mut Numbers::new(bytes));
}

fn check<R: Real>(numbers: &mut Numbers) {
    let coordinates = |numbers: &mut Numbers| numbers.vector_within::<R, 3>(1e6);
    let Ok(disk) = Disk::new(coordinates(numbers), coordinates(numbers), numbers.positive(6)) else { return };
    let Ok(receiver) = Receiver::new(coordinates(numbers), coordinates(numbers)) else { return };
    let request = Request {
        relative_error: R::from_f64([0.3, 0.1, 1e-2, 1e-3, 1e-5][numbers.below(5)]),
        max_samples: 1 + usize::from(numbers.byte()) * 16,
        strata: numbers.below(5),
    };
    let [a, b, c]: [R; 3] = numbers.vector_within(10.0);
    let edge: [R; 3] = numbers.vector_within(2.0);
    let (uniform, open) = (numbers.byte().is_multiple_of(4), numbers.byte().is_multiple_of(2));
    let respond = |aim: &Aim<R>| {
        let [x, y] = aim.on_disk;
        assert_in(x.hypot(y), 0.0, 1.0 + 1e-5, "the point on the disk");
        assert_in(aim.cosine, 0.0, 1.0 + 1e-5, "the cosine");
        let value = a + b * x + c * y;
        let lit = open || edge[0] * x + edge[1] * y <= edge[2];
        Response {
            emission: if uniform { R::ONE } else { value * value },
            visibility: if lit { R::ONE } else { R::ZERO },
        }
    };
    let exact = disk_configuration_factor(&disk, &receiver);
    let mut panels = [Panel::default(); 32];
    let found = integrate(&disk, &receiver, &request, &mut panels, respond).expect("a request in range");
    // At most (|a| + |b| + |c|)² times the factor of uniform light.
    let most = if uniform { 1.0 } else { (a.abs() + b.abs() + c.abs()).to_f64().powi(2) };
    assert_in(found.value, 0.0, most * exact.to_f64() * 1.5 + 1e-30, "estimate");
    assert_in(found.error, 0.0, f64::MAX, "error");
    if uniform && open && exact.to_f64() >= 1e-15 {
        assert!(found.status == Status::Met || found.samples > 0);
        let off = (found.value - exact).abs().to_f64() / exact.to_f64();
        assert!(off <= 1e3 * R::EPSILON.to_f64(), "uniform light is {off} off: {found:?}, {exact}");
    }
    if uniform {
        let found = ratio(&disk, &receiver, exact, &request, &mut panels, respond).expect("a request in range");
        assert_in(found.value, 0.0, exact.to_f64() * (1.0 + 1e-5), "ratio");
    }
}
