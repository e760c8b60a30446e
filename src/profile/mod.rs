//! Where the matter is: relative density along rays, in closed form.
//!
//! A profile answers four questions, in this order: `density`, `column`, `inv_column`,
//! `bounds`; the first at a point and along a ray, the second also with its derivatives, the
//! last on a segment and in a box.
//! Spectra never enter a profile. The list of profiles stands here, once: to add one, write
//! its file, and add a line to `profiles!` below.

pub mod anisotropic_gaussian;
pub mod constant;
pub mod exponential;
pub mod gaussian;
pub mod gradient;
mod layers;
pub mod linear;
pub mod radial_gaussian;
pub mod spherical;
pub mod tent;

use crate::error::Error;
use crate::geometry::{Ray, Vector};
use crate::real::Real;
use gradient::Gradient;

/// The questions. Distances and columns are lengths ≥ 0 and may be infinite.
pub trait Profile<R: Real> {
    /// Relative density at `point`, ≥ 0.
    fn density(&self, point: Vector<R>) -> R;

    /// Relative density at the finite distance `t` along the ray, and its derivative by `t`.
    fn density_along(&self, ray: &Ray<R>, t: R) -> (R, R);

    /// N(t) = ∫₀ᵗ ρ ds, length. Does not decrease with `t` by more than rounding.
    fn column(&self, ray: &Ray<R>, t: R) -> R;

    /// The smallest distance at which the ray has gathered `column`; infinite if it never does.
    fn inv_column(&self, ray: &Ray<R>, column: R) -> R;

    /// The same for a column that the ray is known to gather: it need not be found out whether it
    /// does. Anything for other columns. Has no derivatives.
    fn inv_reached_column(&self, ray: &Ray<R>, column: R) -> R {
        self.inv_column(ray, column).detach()
    }

    /// A finite distance near `inv_column`, in closed form, for iterations to start from.
    fn guess_inv_column(&self, ray: &Ray<R>, column: R) -> R {
        self.inv_column(ray, column)
    }

    /// Whether `inv_column` is in closed form.
    fn closed_inverse(&self) -> bool {
        true
    }

    /// N(t), and its derivatives by parameters, ray and `t`: see [`gradient`].
    fn column_value_and_gradient(&self, ray: &Ray<R>, t: R) -> (R, Gradient<R>);

    /// `inv_column`, and its derivatives by parameters, ray and `column`.
    fn inv_column_value_and_gradient(&self, ray: &Ray<R>, column: R) -> (R, Gradient<R>) {
        let t = self.inv_column(ray, column);
        gradient::of_inverse(t, |t| self.column_value_and_gradient(ray, t))
    }

    /// Infimum and supremum of the density on a segment of length `t`. True bounds: the
    /// infimum is not above, and the supremum not below, the density at any point of it.
    fn bounds(&self, ray: &Ray<R>, t: R) -> (R, R);

    /// The same in the axis-aligned box with the corners `lo` and `hi`.
    fn bounds_in_box(&self, lo: Vector<R>, hi: Vector<R>) -> (R, R);

    /// The same profile without the derivatives of its parameters.
    #[must_use]
    fn detach(&self) -> Self;
}

/// A parameter of a profile: what scenes, Python and C call it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name, as in a scene.
    pub name: &'static str,
    /// Number of components: 1, or 3 for a vector.
    pub size: usize,
    /// Value if none is given; `None` if it must be given.
    pub default: Option<&'static [f64]>,
}

impl Parameter {
    const UP: Self = Self {
        name: "up",
        size: 3,
        default: Some(&[0.0, 0.0, 1.0]),
    };

    const CENTER: Self = Self {
        name: "center",
        size: 3,
        default: None,
    };

    const BASE_HEIGHT: Self = Self {
        name: "base_height",
        size: 1,
        default: Some(&[0.0]),
    };

    const fn axis(name: &'static str) -> Self {
        Self {
            name,
            size: 3,
            default: None,
        }
    }

    const fn required(name: &'static str) -> Self {
        Self {
            name,
            size: 1,
            default: None,
        }
    }
}

/// Declares [`Kind`], [`AnyProfile`] and the dispatch between profiles, from one list.
macro_rules! profiles {
    ($( $(#[$doc:meta])* $Profile:ident $(<$R:ident>)? = $number:literal, $name:literal, in $module:ident; )*) => {
        /// The kinds of profile. Numbers are fixed for ever.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u32)]
        pub enum Kind { $( $(#[$doc])* $Profile = $number, )* }

        impl Kind {
            /// All kinds.
            pub const ALL: &[Self] = &[$( Self::$Profile, )*];

            /// Name, as in a scene.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self { $( Self::$Profile => $name, )* }
            }

            /// The parameters, in the order in which they are passed.
            #[must_use]
            pub fn parameters(self) -> &'static [Parameter] {
                match self { $( Self::$Profile => $module::PARAMETERS, )* }
            }

            /// Checks the values of the parameters.
            fn check(self, values: &[f64]) -> Result<(), Error> {
                match self { $( Self::$Profile => $module::check(values), )* }
            }
        }

        /// A profile of any kind.
        #[derive(Clone, Copy, Debug)]
        pub enum AnyProfile<R> { $( $(#[$doc])* $Profile($module::$Profile $(<$R>)?), )* }

        impl<R: Real> AnyProfile<R> {
            /// The profile with these parameter values, unchecked.
            ///
            /// # Panics
            /// If there are fewer values than the kind has components of parameters.
            pub fn from_values(kind: Kind, values: &[R]) -> Self {
                match kind { $( Kind::$Profile => Self::$Profile($module::from_values(values)), )* }
            }
        }

        impl<R: Real> Profile<R> for AnyProfile<R> {
            fn density(&self, point: Vector<R>) -> R {
                match self { $( Self::$Profile(p) => p.density(point), )* }
            }
            fn density_along(&self, ray: &Ray<R>, t: R) -> (R, R) {
                match self { $( Self::$Profile(p) => p.density_along(ray, t), )* }
            }
            fn column(&self, ray: &Ray<R>, t: R) -> R {
                match self { $( Self::$Profile(p) => p.column(ray, t), )* }
            }
            fn inv_column(&self, ray: &Ray<R>, column: R) -> R {
                match self { $( Self::$Profile(p) => p.inv_column(ray, column), )* }
            }
            fn inv_reached_column(&self, ray: &Ray<R>, column: R) -> R {
                match self { $( Self::$Profile(p) => p.inv_reached_column(ray, column), )* }
            }
            fn column_value_and_gradient(&self, ray: &Ray<R>, t: R) -> (R, Gradient<R>) {
                match self { $( Self::$Profile(p) => p.column_value_and_gradient(ray, t), )* }
            }
            fn guess_inv_column(&self, ray: &Ray<R>, column: R) -> R {
                match self { $( Self::$Profile(p) => p.guess_inv_column(ray, column), )* }
            }
            fn closed_inverse(&self) -> bool {
                match self { $( Self::$Profile(p) => Profile::<R>::closed_inverse(p), )* }
            }
            fn bounds(&self, ray: &Ray<R>, t: R) -> (R, R) {
                match self { $( Self::$Profile(p) => p.bounds(ray, t), )* }
            }
            fn bounds_in_box(&self, lo: Vector<R>, hi: Vector<R>) -> (R, R) {
                match self { $( Self::$Profile(p) => p.bounds_in_box(lo, hi), )* }
            }
            fn detach(&self) -> Self {
                match self { $( Self::$Profile(p) => Self::$Profile(Profile::<R>::detach(p)), )* }
            }
        }
    };
}

profiles! {
    /// ρ = 1 everywhere.
    Constant = 0, "constant", in constant;
    /// ρ affine in altitude, clamped at zero.
    Linear<R> = 1, "linear", in linear;
    /// ρ exponential in altitude.
    Exponential<R> = 2, "exponential", in exponential;
    /// ρ exponential in altitude above a sphere.
    Spherical<R> = 3, "spherical", in spherical;
    /// ρ linear in altitude above a sphere, on both sides of a peak.
    Tent<R> = 4, "tent", in tent;
    /// ρ Gaussian in the distance from a point.
    Gaussian<R> = 5, "gaussian", in gaussian;
    /// ρ Gaussian along three axes.
    AnisotropicGaussian<R> = 6, "anisotropic_gaussian", in anisotropic_gaussian;
    /// ρ Gaussian in the distance from the centre of a sphere.
    RadialGaussian<R> = 7, "radial_gaussian", in radial_gaussian;
}

impl Kind {
    /// Number of values that [`AnyProfile::from_values`] takes.
    #[must_use]
    pub fn size(self) -> usize {
        self.parameters().iter().map(|p| p.size).sum()
    }

    /// The kind with this number.
    #[must_use]
    pub fn from_number(number: u32) -> Option<Self> {
        Self::ALL
            .iter()
            .copied()
            .find(|kind| *kind as u32 == number)
    }

    /// The kind with this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name)
    }
}

impl AnyProfile<f64> {
    /// The profile with these parameter values, checked.
    ///
    /// # Errors
    /// If the number of values is wrong, or a value is outside its range.
    pub fn new(kind: Kind, values: &[f64]) -> Result<Self, Error> {
        if values.len() != kind.size() {
            let reason = "must have as many values as the profile has parameters";
            return Err(Error::new("parameters", reason, values));
        }
        kind.check(values)?;
        Ok(Self::from_values(kind, values))
    }
}
