//! Random rays and media, from a fixed seed.

use analytic_media::geometry::Ray;
use analytic_media::medium::Medium;
use analytic_media::profile::{AnyProfile, Kind};
use analytic_media::real::Real;

/// A stream of random numbers.
pub struct Random(fastrand::Rng);

/// Values of a medium: kind and parameters of each profile, and its σ_t.
pub type Components = Vec<(Kind, Vec<f64>, f64)>;

impl Random {
    pub fn with_seed(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0.f64()
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Log-uniform in [low, high).
    pub fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub fn sign(&mut self) -> f64 {
        if self.0.bool() { 1.0 } else { -1.0 }
    }

    /// Below `n`.
    pub fn index(&mut self, n: usize) -> usize {
        self.0.usize(..n)
    }

    /// One of `items`.
    pub fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.index(items.len())]
    }

    /// A unit vector, uniform on the sphere.
    pub fn direction(&mut self) -> [f64; 3] {
        let (z, angle) = (
            self.between(-1.0, 1.0),
            self.between(0.0, std::f64::consts::TAU),
        );
        let r = (1.0 - z * z).sqrt();
        [r * angle.cos(), r * angle.sin(), z]
    }

    /// A unit vector with the cosine `mu` to the z axis.
    pub fn direction_with(&mut self, mu: f64) -> [f64; 3] {
        let angle = self.between(0.0, std::f64::consts::TAU);
        let r = (1.0 - mu * mu).sqrt();
        [r * angle.cos(), r * angle.sin(), mu]
    }

    /// A ray from within ±`extent`: up, down, horizontal, nearly so, or anywhere.
    pub fn ray(&mut self, extent: f64) -> Ray<f64> {
        let origin = std::array::from_fn(|_| self.between(-extent, extent));
        let direction = match self.index(8) {
            0 => [0.0, 0.0, 1.0],
            1 => [0.0, 0.0, -1.0],
            2 => [1.0, 0.0, 0.0],
            3 => {
                let mu = self.sign() * self.magnitude(1e-9, 1e-2);
                self.direction_with(mu)
            }
            _ => self.direction(),
        };
        Ray { origin, direction }
    }

    /// Three orthogonal axes of random lengths.
    pub fn axes(&mut self, low: f64, high: f64) -> [f64; 9] {
        let (a, b) = (self.direction(), self.direction());
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ]
        };
        let c = cross(a, b);
        let length = c.iter().map(|x| x * x).sum::<f64>().sqrt();
        let c = c.map(|x| x / length);
        let mut axes = [0.0; 9];
        for (k, axis) in [a, cross(c, a), c].into_iter().enumerate() {
            let deviation = self.magnitude(low, high);
            for i in 0..3 {
                axes[3 * k + i] = axis[i] * deviation;
            }
        }
        axes
    }

    /// Two to four components of any kind, with lengths around 1.
    pub fn components(&mut self) -> Components {
        let count = 2 + self.index(3);
        (0..count).map(|_| self.component()).collect()
    }

    fn component(&mut self) -> (Kind, Vec<f64>, f64) {
        let sigma = self.magnitude(1e-3, 10.0);
        // Gaps and kinks of tents need more steps than sums of smooth profiles.
        let smooth = Kind::ALL.iter().copied().filter(|kind| *kind != Kind::Tent);
        let kind = self.pick(&smooth.collect::<Vec<_>>());
        let up = if self.unit() < 0.5 {
            [0.0, 0.0, 1.0]
        } else {
            self.direction()
        };
        let scale = self.magnitude(0.1, 100.0);
        let center: [f64; 3] = std::array::from_fn(|_| self.between(-5.0, 5.0));
        // A planet whose surface is within 5 of the origin.
        let radius = self.magnitude(10.0, 1e3);
        let planet = up.map(|x| -x * radius);
        let values = match kind {
            Kind::Constant => vec![],
            Kind::Linear => {
                let gradient = self.sign() * self.magnitude(1e-3, 1.0);
                let shape = [center[0], gradient, self.between(-1.0, 2.0)];
                [up.to_vec(), shape.to_vec()].concat()
            }
            Kind::Exponential => [&up[..], &[center[0], scale]].concat(),
            Kind::Spherical | Kind::RadialGaussian => {
                [&planet[..], &[radius + center[0].min(0.0), scale]].concat()
            }
            Kind::Tent => [&planet[..], &[radius, center[0], scale]].concat(),
            Kind::Gaussian => [&center[..], &[scale]].concat(),
            Kind::AnisotropicGaussian => [&center[..], &self.axes(0.1, 100.0)].concat(),
        };
        (kind, values, sigma)
    }
}

/// The medium of these components, with its numbers lifted from f64.
pub fn medium<R: Real>(components: &Components, lift: impl Fn(f64) -> R) -> Medium<R> {
    let profile = |(kind, values, _): &(Kind, Vec<f64>, f64)| {
        let values: Vec<R> = values.iter().map(|v| lift(*v)).collect();
        AnyProfile::from_values(*kind, &values)
    };
    let sigma_t = components.iter().map(|(_, _, sigma)| lift(*sigma));
    Medium::new(components.iter().map(profile).collect(), sigma_t.collect())
}

/// The ray, with its numbers lifted from f64.
pub fn ray<R: Real>(ray: &Ray<f64>, lift: impl Fn(f64) -> R) -> Ray<R> {
    Ray {
        origin: ray.origin.map(&lift),
        direction: ray.direction.map(&lift),
    }
}
