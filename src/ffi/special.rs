//! Special functions: the Chapman function and its relatives, the cheap approximations that the
//! article compares, and exponential integrals.

use super::array::Array;
use super::function::{self, functions};
use super::{AmArrayF32, AmArrayF64, AmHostTable, AmNode, AmStatus, arg, guard, query};
use crate::error;
use crate::real::lanes::{F32Lanes, F64Lanes, Lanes};
use crate::real::node::Node;
use crate::special::{approximations, bessel, chapman, erfcx, expint};

functions! {
    /// Chapman function C(z, θ): the column of a ray to infinity through an exponential
    /// atmosphere, relative to that of a vertical ray from the same place. Dimensionless, > 0.
    ///
    /// `z` = r/H ≥ 0 is the distance from the centre in scale heights, `cos_zenith` in [−1, 1] is
    /// positive upwards. The planet is transparent: below the horizontal the value grows to
    /// 2 exp(z) − 1, and overflows to ∞. Relative error below 1e-13, in single precision 1e-6.
    /// Source: article, Eq. 42; Chapman (1931).
    ///
    /// # Safety
    /// `value` points to one number.
    am_chapman_f64 am_chapman_f32 am_chapman_batch_f64 am_chapman_batch_f32 am_chapman_record
    |z: not_negative, cos_zenith: cosine| => chapman::chapman

    /// Natural logarithm of the Chapman function, finite where that overflows.
    ///
    /// # Safety
    /// `value` points to one number.
    am_log_chapman_f64 am_log_chapman_f32
    am_log_chapman_batch_f64 am_log_chapman_batch_f32 am_log_chapman_record
    |z: not_negative, cos_zenith: cosine| => chapman::log_chapman

    /// Rescaled Chapman function exp(Z − z) C(z, θ), `surface` = Z = R/H. Times H it is the column
    /// of a ray where the density at the surface is 1. Source: article, Eq. 43.
    ///
    /// # Safety
    /// `value` points to one number.
    am_chapman_rescaled_f64 am_chapman_rescaled_f32
    am_chapman_rescaled_batch_f64 am_chapman_rescaled_batch_f32 am_chapman_rescaled_record
    |z: not_negative, surface: finite, cos_zenith: cosine| => chapman::rescaled

    /// Natural logarithm of the rescaled Chapman function.
    ///
    /// # Safety
    /// `value` points to one number.
    am_log_chapman_rescaled_f64 am_log_chapman_rescaled_f32
    am_log_chapman_rescaled_batch_f64 am_log_chapman_rescaled_batch_f32
    am_log_chapman_rescaled_record
    |z: not_negative, surface: finite, cos_zenith: cosine| => chapman::log_rescaled

    /// Chapman function of the upper hemisphere alone, 0 ≤ `cos_zenith` ≤ 1: half the operations
    /// where it is recorded.
    ///
    /// # Safety
    /// `value` points to one number.
    am_chapman_upper_f64 am_chapman_upper_f32
    am_chapman_upper_batch_f64 am_chapman_upper_batch_f32 am_chapman_upper_record
    |z: not_negative, cos_zenith: upward_cosine| => chapman::upper

    /// Chapman function of the lower hemisphere alone, −1 ≤ `cos_zenith` ≤ 0.
    ///
    /// # Safety
    /// `value` points to one number.
    am_chapman_lower_f64 am_chapman_lower_f32
    am_chapman_lower_batch_f64 am_chapman_lower_batch_f32 am_chapman_lower_record
    |z: not_negative, cos_zenith: downward_cosine| => chapman::lower

    /// z exp(z) K₁(z), K₁ the modified Bessel function of the second kind: the Chapman function of
    /// horizontal rays. 1 at z = 0. Source: article, Eq. 47.
    ///
    /// # Safety
    /// `value` points to one number.
    am_bessel_k1_scaled_f64 am_bessel_k1_scaled_f32
    am_bessel_k1_scaled_batch_f64 am_bessel_k1_scaled_batch_f32 am_bessel_k1_scaled_record
    |z: not_negative| => bessel::k1_scaled

    /// exp(x²) erfc(x), the scaled complementary error function, for any `x`; ∞ where it
    /// overflows, below −26.6 (in single precision −9.3).
    ///
    /// # Safety
    /// `value` points to one number.
    am_erfcx_f64 am_erfcx_f32 am_erfcx_batch_f64 am_erfcx_batch_f32 am_erfcx_record
    |x: finite| => erfcx::erfcx

    /// Approximation of the Chapman function for large `z` > 0. Relative error upwards 8 % at
    /// z = 1, 3e-5 at 100, 1e-6 beyond 800. Source: article, Eq. 46 to 48; Huestis (2001).
    ///
    /// # Safety
    /// `value` points to one number.
    am_chapman_huestis_f64 am_chapman_huestis_f32
    am_chapman_huestis_batch_f64 am_chapman_huestis_batch_f32 am_chapman_huestis_record
    |z: positive, cos_zenith: cosine| => approximations::chapman_huestis

    /// Approximation of z exp(z) K₁(z) for large `z` > 0. Relative error 4 % at z = 1, 1e-7 at 100.
    /// Source: article, Eq. 47; Huestis (2001).
    ///
    /// # Safety
    /// `value` points to one number.
    am_chapman_horizontal_huestis_f64 am_chapman_horizontal_huestis_f32
    am_chapman_horizontal_huestis_batch_f64 am_chapman_horizontal_huestis_batch_f32
    am_chapman_horizontal_huestis_record
    |z: positive| => approximations::chapman_horizontal_huestis

    /// Approximation of the Chapman function upwards, `z` > 0. Relative error 12 % at z = 100,
    /// 15 % beyond. Source: article, Eq. 49; Schüler (2012).
    ///
    /// # Safety
    /// `value` points to one number.
    am_chapman_schueler_f64 am_chapman_schueler_f32
    am_chapman_schueler_batch_f64 am_chapman_schueler_batch_f32 am_chapman_schueler_record
    |z: positive, cos_zenith: upward_cosine| => approximations::chapman_schueler

    /// Approximation of the Chapman function upwards, `z` > 0, by a rational function and square
    /// roots. Source: draft of the article, Eq. 45; Kocifaj (1996).
    ///
    /// # Safety
    /// `value` points to one number.
    am_chapman_kocifaj_f64 am_chapman_kocifaj_f32
    am_chapman_kocifaj_batch_f64 am_chapman_kocifaj_batch_f32 am_chapman_kocifaj_record
    |z: positive, cos_zenith: upward_cosine| => approximations::chapman_kocifaj

    /// Approximation of exp(x²) erfc(x) for `x` ≥ 0. Relative error 1.8e-6.
    /// Source: article, `Exp2Erfc`.
    ///
    /// # Safety
    /// `value` points to one number.
    am_erfcx_golubev_f64 am_erfcx_golubev_f32
    am_erfcx_golubev_batch_f64 am_erfcx_golubev_batch_f32 am_erfcx_golubev_record
    |x: not_negative| => approximations::erfcx_golubev

    /// Approximation of exp(x²) erfc(x) for `x` ≥ 0. Relative error 3.4e-3.
    /// Source: draft of the article, Eq. 44; Ren and MacKenzie (2007).
    ///
    /// # Safety
    /// `value` points to one number.
    am_erfcx_ren_mackenzie_f64 am_erfcx_ren_mackenzie_f32
    am_erfcx_ren_mackenzie_batch_f64 am_erfcx_ren_mackenzie_batch_f32
    am_erfcx_ren_mackenzie_record
    |x: not_negative| => approximations::erfcx_ren_mackenzie

    /// Exponential integral Ei(z) of z = `x` + i `y`, principal branch; on the real axis the principal
    /// value. −∞ at 0, infinite or not a number where e^x overflows.
    ///
    /// |error| below 1e-12 |Ei|, in single precision 2e-6 |Ei|, for |y| ≤ 1000.
    /// Source: Pegoraro, Schott, Parker (2009), Eq. 21 to 27.
    ///
    /// # Safety
    /// `value` points to two numbers, the real and the imaginary part: of item 0, of item 1, ….
    am_expint_ei_f64 am_expint_ei_f32 am_expint_ei_batch_f64 am_expint_ei_batch_f32
    am_expint_ei_record
    |x: finite, y: finite| => expint::ei

    /// exp(−z) (Ei(z) − iπ sgn(y)) of z = `x` + i `y`: about 1/z for large |z|. Without the jump and
    /// the exponential of Ei, which overflows.
    ///
    /// |error| below 1e-12, in single precision 2e-6, relative to the value.
    ///
    /// # Safety
    /// `value` points to two numbers, the real and the imaginary part: of item 0, of item 1, ….
    am_expint_ei_scaled_f64 am_expint_ei_scaled_f32
    am_expint_ei_scaled_batch_f64 am_expint_ei_scaled_batch_f32 am_expint_ei_scaled_record
    |x: finite, y: finite| => expint::ei_scaled

    /// Exponential integral E₁(x) = −Ei(−x), `x` > 0. Relative error below 1e-12, in single precision
    /// 2e-6; 0 where it underflows.
    ///
    /// # Safety
    /// `value` points to one number.
    am_expint_e1_f64 am_expint_e1_f32 am_expint_e1_batch_f64 am_expint_e1_batch_f32
    am_expint_e1_record
    |x: positive| => expint::e1

    /// exp(x) E₁(x), `x` > 0: about 1/x for large x. Relative error below 1e-12, in single precision
    /// 2e-6.
    ///
    /// # Safety
    /// `value` points to one number.
    am_expint_e1_scaled_f64 am_expint_e1_scaled_f32
    am_expint_e1_scaled_batch_f64 am_expint_e1_scaled_batch_f32 am_expint_e1_scaled_record
    |x: positive| => expint::e1_scaled
}
