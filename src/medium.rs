//! A medium: the sum of components, each a profile times an attenuation coefficient.
//!
//!     τ(t) = Σ_c σ_c N_c(t),   T = e^(−τ),   O = 1 − T               (article, Eq. 8–11)
//!
//! Spectra: the columns of the components are computed once and serve every channel.

use crate::geometry::{Ray, Vector};
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
