//! A medium: the sum of components, each a profile times an attenuation coefficient.
//!
//!     τ(t) = Σ_c σ_c N_c(t),   T = e^(−τ),   O = 1 − T               (article, Eq. 8–11)
//!
//! Spectra: the columns of the components are computed once and serve every channel.

use crate::geometry::{Ray, Vector};
use crate::profile::gradient::{Gradient, Parameters, held, implicit, reciprocal};
use crate::profile::{AnyProfile, Profile};
use crate::real::Real;
use crate::special::rel::phi;

/// The sum of at least one component, in one or more channels.
#[derive(Clone, Debug)]
pub struct Medium<R> {
    profiles: Vec<AnyProfile<R>>,
    /// σ_t: attenuation at relative density 1, 1/length, ≥ 0; channels of the first
    /// component, of the second, and so on.
    sigma_t: Vec<R>,
}

/// The derivatives of a number that was asked of a medium.
#[derive(Clone, Debug)]
pub struct MediumGradient<R> {
    /// By σ_t of each component, and by the parameters of its profile.
    pub components: Vec<(R, Parameters<R>)>,
    /// By the origin of the ray.
    pub origin: Vector<R>,
    /// By its direction, as a free vector.
    pub direction: Vector<R>,
    /// By the last argument of the question: the distance, or the optical depth.
    pub last: R,
}

impl<R: Real> MediumGradient<R> {
    /// All derivatives in one row: σ_t and parameters of the first component, of the second,
    /// …, origin, direction, last argument.
    pub fn row(&self) -> impl Iterator<Item = R> {
        let components = self.components.iter();
        components
            .flat_map(|(sigma, parameters)| std::iter::once(sigma).chain(parameters))
            .chain(&self.origin)
            .chain(&self.direction)
            .chain([&self.last])
            .copied()
    }

    /// Changes all derivatives but the last.
    fn each(&mut self, f: impl Fn(R) -> R) {
        for (sigma, parameters) in &mut self.components {
            *sigma = f(*sigma);
            parameters.iter_mut().for_each(|x| *x = f(*x));
        }
        self.origin = self.origin.map(&f);
        self.direction = self.direction.map(&f);
    }

    /// That of the distance at which an optical depth is reached: (3) of
    /// [`crate::profile::gradient`].
    pub(crate) fn implicit(self, reached: R::Mask) -> Self {
        let (by_goal, dense) = reciprocal(self.last, reached);
        let mut inverse = Self {
            last: by_goal,
            ..self
        };
        inverse.each(|x| implicit(x, by_goal, dense));
        inverse
    }
}

/// T = e^(−τ), 1.
pub fn transmittance<R: Real>(optical_depth: R) -> R {
    (-optical_depth).exp()
}

/// O = 1 − e^(−τ) = τ φ(τ), 1; keeps small optical depths.
pub fn opacity<R: Real>(optical_depth: R) -> R {
    let thick = optical_depth.lit(100.0).lt(optical_depth);
    let thin = R::select(thick, optical_depth.lit(0.0), optical_depth);
    R::select(thick, optical_depth.lit(1.0), thin * phi(thin))
}

/// `sigma` · `amount`, where nothing of an infinite amount is nothing.
pub(crate) fn attenuate<R: Real>(sigma: R, amount: R) -> R {
    let clear = sigma.le(sigma.lit(0.0));
    R::select(
        clear,
        sigma.lit(0.0),
        sigma * R::select(clear, sigma.lit(0.0), amount),
    )
}

impl<R: Real> Medium<R> {
    /// The sum of `profiles`; `sigma_t` has the channels of the first, of the second, ….
    ///
    /// # Panics
    /// If there is no profile, or not the same number of channels for each.
    #[must_use]
    pub fn new(profiles: Vec<AnyProfile<R>>, sigma_t: Vec<R>) -> Self {
        assert!(!profiles.is_empty(), "a medium has a component");
        assert!(
            !sigma_t.is_empty() && sigma_t.len() % profiles.len() == 0,
            "every component has the same number of channels"
        );
        Self { profiles, sigma_t }
    }

    /// The profiles of the components.
    #[must_use]
    pub fn profiles(&self) -> &[AnyProfile<R>] {
        &self.profiles
    }

    /// Number of channels.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.sigma_t.len() / self.profiles.len()
    }

    /// σ_t of a component in a channel.
    #[must_use]
    pub fn sigma_t(&self, component: usize, channel: usize) -> R {
        self.sigma_t[component * self.channels() + channel]
    }

    /// σ_c amount_c in one channel, for each component.
    pub fn shares(&self, channel: usize, amount: impl Fn(&AnyProfile<R>) -> R) -> Vec<R> {
        let share = |(c, profile)| attenuate(self.sigma_t(c, channel), amount(profile));
        self.profiles.iter().enumerate().map(share).collect()
    }

    /// Σ_c σ_c amount_c in one channel.
    pub fn attenuate(&self, channel: usize, amount: impl Fn(&AnyProfile<R>) -> R) -> R {
        self.shares(channel, amount)
            .into_iter()
            .reduce(|a, b| a + b)
            .expect("a medium has a component")
    }

    /// Σ_c σ_c amount_c in every channel; each amount is computed once.
    pub fn attenuate_all(&self, amount: impl Fn(&AnyProfile<R>) -> R) -> impl Iterator<Item = R> {
        let amounts: Vec<R> = self.profiles.iter().map(amount).collect();
        (0..self.channels()).map(move |channel| {
            amounts
                .iter()
                .enumerate()
                .map(|(c, amount)| attenuate(self.sigma_t(c, channel), *amount))
                .reduce(|a, b| a + b)
                .expect("a medium has a component")
        })
    }

    /// σ_t at `point` in every channel, 1/length.
    pub fn extinction(&self, point: Vector<R>) -> impl Iterator<Item = R> {
        self.attenuate_all(move |profile| profile.density(point))
    }

    /// τ of the segment of length `t` in every channel; dimensionless. `t` may be infinite.
    pub fn optical_depth(&self, ray: &Ray<R>, t: R) -> impl Iterator<Item = R> {
        self.attenuate_all(move |profile| profile.column(ray, t))
    }

    /// τ of the segment of length `t` in every channel, and its derivatives: by σ_t of the
    /// component and by the parameters of its profile, for each component; by the ray and by
    /// `t`. See [`crate::profile::gradient`].
    ///
    ///     ∂τ/∂σ_c = N_c,   ∂τ/∂θ = Σ_c σ_c ∂N_c/∂θ
    pub fn optical_depth_value_and_gradient(
        &self,
        ray: &Ray<R>,
        t: R,
    ) -> impl Iterator<Item = (R, MediumGradient<R>)> {
        let columns = self.columns_and_gradients(ray, t);
        (0..self.channels()).map(move |channel| self.weigh(channel, &columns))
    }

    /// The same in one channel.
    pub(crate) fn optical_depth_value_and_gradient_in(
        &self,
        channel: usize,
        ray: &Ray<R>,
        t: R,
    ) -> (R, MediumGradient<R>) {
        self.weigh(channel, &self.columns_and_gradients(ray, t))
    }

    fn columns_and_gradients(&self, ray: &Ray<R>, t: R) -> Vec<(R, Gradient<R>)> {
        let profiles = self.profiles.iter();
        profiles
            .map(|profile| profile.column_value_and_gradient(ray, t))
            .collect()
    }

    /// σ_c times columns and their derivatives, summed over the components.
    fn weigh(&self, channel: usize, columns: &[(R, Gradient<R>)]) -> (R, MediumGradient<R>) {
        let zero = columns[0].0.lit(0.0);
        let mut value = zero;
        let mut gradient = MediumGradient {
            components: Vec::with_capacity(columns.len()),
            origin: [zero; 3],
            direction: [zero; 3],
            last: zero,
        };
        for (c, (column, by)) in columns.iter().enumerate() {
            let sigma = self.sigma_t(c, channel);
            value = value + attenuate(sigma, *column);
            let by = by.clone().map(|x| attenuate(sigma, x));
            for i in 0..3 {
                gradient.origin[i] = gradient.origin[i] + by.origin[i];
                gradient.direction[i] = gradient.direction[i] + by.direction[i];
            }
            gradient.last = gradient.last + by.last;
            gradient.components.push((*column, by.parameters));
        }
        let bounded = value.is_bounded();
        gradient.each(|x| held(x, bounded));
        gradient.last = held(gradient.last, bounded);
        (value, gradient)
    }

    /// Minorant and majorant of σ_t on the segment in every channel, 1/length.
    pub fn bounds(&self, ray: &Ray<R>, t: R) -> impl Iterator<Item = (R, R)> {
        self.attenuate_all(move |profile| profile.bounds(ray, t).0)
            .zip(self.attenuate_all(move |profile| profile.bounds(ray, t).1))
    }

    /// Minorant and majorant of σ_t in the box in every channel, 1/length.
    pub fn bounds_in_box(&self, lo: Vector<R>, hi: Vector<R>) -> impl Iterator<Item = (R, R)> {
        self.attenuate_all(move |profile| profile.bounds_in_box(lo, hi).0)
            .zip(self.attenuate_all(move |profile| profile.bounds_in_box(lo, hi).1))
    }

    /// The same medium without the derivatives of its parameters.
    #[must_use]
    pub fn detach(&self) -> Self {
        Self {
            profiles: self.profiles.iter().map(Profile::detach).collect(),
            sigma_t: self.sigma_t.iter().map(|sigma| sigma.detach()).collect(),
        }
    }
}
