//! Air-light: light of a point source that a uniform medium scatters once.

use super::array::Array;
use super::query::{
    self, Model, RecordedModel, argument_check, argument_type, argument_value, queries,
};
use super::{AmArrayF32, AmArrayF64, AmHostTable, AmNode, AmStatus, Failure, arg, guard};
use crate::airlight::AirLight;
use crate::airlight::closed_form::{self, Expansion};
use crate::airlight::light::{Intensity, Light};
use crate::airlight::phase::{Deflection, Phase, PhaseFunction};
use crate::airlight::published::{self, Form};
use crate::airlight::quadrature;
use crate::error::{self, Error};
use crate::geometry::Ray;
use crate::real::Real;
use crate::real::lanes::{F32Lanes, F64Lanes, Lanes};
use crate::real::node::Node;
use libc::c_void;

/// How the intensity of a light depends on the angle θ from its axis. Numbers are fixed for ever.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum AmLightKind {
    /// 1 in all directions.
    Isotropic = 0,
    /// cos θ to the power `exponent`, which is even: two lobes.
    Lobes = 1,
    /// max(0, cos θ) to the power `exponent`: one lobe.
    Spot = 2,
    /// 1 up to `beam_width`, then linear in θ down to 0 at `cutoff_angle`, as the emitter `spot` of
    /// Mitsuba.
    Cone = 3,
}

/// Phase functions, of integral 1. Numbers are fixed for ever.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum AmPhaseKind {
    /// 1/(4π).
    Isotropic = 0,
    /// 3/(16π) (1 + cos² φ).
    Rayleigh = 1,
    /// (1 − g²)/(4π) (1 + g² − 2g cos φ)^(−3/2): Henyey and Greenstein.
    HenyeyGreenstein = 2,
}

/// A point light of intensity 1 on its axis. Fields that the kind has no use for may hold anything.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmLight {
    /// Kind of light, from `am_light_kind`.
    pub kind: u32,
    /// Of the cosine, 1 to 1024; even for lobes.
    pub exponent: u32,
    /// Where the light is, lengths.
    pub position: [f64; 3],
    /// Unit vector, the direction in which the light is brightest.
    pub axis: [f64; 3],
    /// Angle from the axis where a cone ends, in (0, π/2), radians.
    pub cutoff_angle: f64,
    /// Angle from the axis where a cone begins to fall, in [0, `cutoff_angle`], radians.
    pub beam_width: f64,
}

/// A light whose numbers are slots of a host's tape. All of them must be slots, even those that the
/// kind has no use for.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmLightNodes {
    /// Kind of light, from `am_light_kind`.
    pub kind: u32,
    /// As `am_light.exponent`: a number, not a slot.
    pub exponent: u32,
    /// Slots of the position.
    pub position: [AmNode; 3],
    /// Slots of the axis.
    pub axis: [AmNode; 3],
    /// Slot of the cutoff angle.
    pub cutoff_angle: AmNode,
    /// Slot of the beam width.
    pub beam_width: AmNode,
}

/// A phase function of the angle φ between the directions in which light arrives and leaves.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmPhase {
    /// Kind of phase function, from `am_phase_kind`.
    pub kind: u32,
    /// Mean cosine, in (−1, 1), positive forward; for `AM_PHASE_KIND_HENYEY_GREENSTEIN` only.
    pub g: f64,
}

/// A phase function whose number is a slot of a host's tape.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmPhaseNodes {
    /// Kind of phase function, from `am_phase_kind`.
    pub kind: u32,
    /// Slot of the mean cosine, even if the kind has no use for it.
    pub g: AmNode,
}

/// A point light in a uniform medium that is everywhere between the light and the ray, in one or
/// more channels (wavelength, colour). It borrows the arrays.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmAirlight {
    /// The light.
    pub light: AmLight,
    /// The phase function of the medium.
    pub phase: AmPhase,
    /// Scattering coefficient of each channel, 1/length, ≥ 0.
    pub sigma_s: *const f64,
    /// Extinction coefficient of each channel, 1/length, ≥ 0: of absorption and scattering.
    pub sigma_t: *const f64,
    /// Number of channels, at least 1.
    pub n_channels: usize,
}

/// An `am_airlight` whose numbers are slots of a host's tape.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmAirlightNodes {
    /// The light.
    pub light: AmLightNodes,
    /// The phase function of the medium.
    pub phase: AmPhaseNodes,
    /// Slots of the scattering coefficients.
    pub sigma_s: *const AmNode,
    /// Slots of the extinction coefficients.
    pub sigma_t: *const AmNode,
    /// Number of channels, at least 1.
    pub n_channels: usize,
}

fn unknown(rule: &str, number: u32) -> Failure {
    Failure::new(AmStatus::InvalidArgument, format!("{rule}, got {number}"))
}

/// The intensity of a light of `kind`.
fn intensity<R>(
    kind: u32,
    exponent: u32,
    [cutoff_angle, beam_width]: [R; 2],
) -> Result<Intensity<R>, Failure> {
    const ISOTROPIC: u32 = AmLightKind::Isotropic as u32;
    const LOBES: u32 = AmLightKind::Lobes as u32;
    const SPOT: u32 = AmLightKind::Spot as u32;
    const CONE: u32 = AmLightKind::Cone as u32;
    let whole = |reason, good: bool| {
        if good {
            return Ok(());
        }
        Err(Error::new("light.exponent", reason, exponent))
    };
    match kind {
        ISOTROPIC => Ok(Intensity::Isotropic),
        LOBES => {
            let even = (2..=1024).contains(&exponent) && exponent % 2 == 0;
            whole("must be even and in [2, 1024]", even)?;
            Ok(Intensity::Lobes { exponent })
        }
        SPOT => {
            whole("must be in [1, 1024]", (1..=1024).contains(&exponent))?;
            Ok(Intensity::Spot { exponent })
        }
        CONE => Ok(Intensity::Cone {
            cutoff_angle,
            beam_width,
        }),
        _ => Err(unknown("light.kind must be one of am_light_kind", kind)),
    }
}

/// The phase function of `kind`.
fn phase<R>(kind: u32, g: R) -> Result<Phase<R>, Failure> {
    const ISOTROPIC: u32 = AmPhaseKind::Isotropic as u32;
    const RAYLEIGH: u32 = AmPhaseKind::Rayleigh as u32;
    const HENYEY_GREENSTEIN: u32 = AmPhaseKind::HenyeyGreenstein as u32;
    match kind {
        ISOTROPIC => Ok(Phase::Isotropic),
        RAYLEIGH => Ok(Phase::Rayleigh),
        HENYEY_GREENSTEIN => Ok(Phase::HenyeyGreenstein { g }),
        _ => Err(unknown("phase.kind must be one of am_phase_kind", kind)),
    }
}

impl AmLight {
    fn lift<R>(&self, lift: impl Fn(f64) -> R) -> Result<Light<R>, Failure> {
        let angles = [self.cutoff_angle, self.beam_width].map(&lift);
        Ok(Light {
            position: self.position.map(&lift),
            axis: self.axis.map(&lift),
            intensity: intensity(self.kind, self.exponent, angles)?,
        })
    }

    /// Checks the numbers that the kind uses.
    fn check(&self) -> Result<(), Failure> {
        error::finite_vector("light.position", self.position)?;
        match self.lift(|x| x)?.intensity {
            Intensity::Isotropic => return Ok(()),
            Intensity::Lobes { .. } | Intensity::Spot { .. } => {}
            Intensity::Cone {
                cutoff_angle,
                beam_width,
            } => {
                error::acute("light.cutoff_angle", cutoff_angle)?;
                if !(0.0..=cutoff_angle).contains(&beam_width) {
                    let reason = "must be in [0, cutoff_angle]";
                    return Err(Error::new("light.beam_width", reason, beam_width).into());
                }
            }
        }
        error::unit("light.axis", self.axis)?;
        Ok(())
    }
}

impl AmLightNodes {
    fn lift<'h>(&self, host: &'h AmHostTable) -> Result<Light<Node<'h>>, Failure> {
        let node = |slot| Node::new(host, slot);
        let angles = [self.cutoff_angle, self.beam_width].map(node);
        Ok(Light {
            position: self.position.map(node),
            axis: self.axis.map(node),
            intensity: intensity(self.kind, self.exponent, angles)?,
        })
    }
}

impl AmAirlight {
    /// Scattering and extinction coefficients.
    fn coefficients(&self) -> Result<[&[f64]; 2], Failure> {
        // SAFETY: promised by the caller who made the struct.
        unsafe { arg::coefficients(self.sigma_s, self.sigma_t, self.n_channels) }
    }
}

impl Model for AmAirlight {
    type In<R: Real> = AirLight<R>;

    fn check(&self) -> Result<(), Failure> {
        self.coefficients()?;
        self.light.lift(|x| x)?;
        phase(self.phase.kind, self.phase.g).map(drop)
    }

    fn lift<R: Real>(&self, lift: impl Fn(f64) -> R) -> AirLight<R> {
        let checked = "the model has been checked";
        let [sigma_s, sigma_t] = self.coefficients().ok().expect(checked);
        AirLight {
            light: self.light.lift(&lift).ok().expect(checked),
            phase: phase(self.phase.kind, lift(self.phase.g))
                .ok()
                .expect(checked),
            sigma_s: sigma_s.iter().map(|s| lift(*s)).collect(),
            sigma_t: sigma_t.iter().map(|s| lift(*s)).collect(),
        }
    }
}

impl RecordedModel for AmAirlightNodes {
    type In<R: Real> = AirLight<R>;

    unsafe fn nodes<'h>(&self, host: &'h AmHostTable) -> Result<AirLight<Node<'h>>, Failure> {
        // SAFETY: promised by the caller.
        let [sigma_s, sigma_t] =
            unsafe { arg::coefficients(self.sigma_s, self.sigma_t, self.n_channels) }?;
        let nodes = |slots: &[AmNode]| slots.iter().map(|slot| Node::new(host, *slot)).collect();
        Ok(AirLight {
            light: self.light.lift(host)?,
            phase: phase(self.phase.kind, Node::new(host, self.phase.g))?,
            sigma_s: nodes(sigma_s),
            sigma_t: nodes(sigma_t),
        })
    }
}

/// Checks the numbers of an `am_airlight`. The question below checks counts, kinds, exponents and
/// pointers only: it answers a light or medium that does not pass with NaN or nonsense, but never
/// fails.
///
/// # Safety
/// `airlight` points to one struct, and its arrays have the lengths that it says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn am_airlight_check(airlight: *const AmAirlight) -> AmStatus {
    guard(|| {
        // SAFETY: promised by the caller.
        let airlight = unsafe { arg::reference(airlight, "airlight") }?;
        let [sigma_s, sigma_t] = airlight.coefficients()?;
        airlight.light.check()?;
        if let Phase::HenyeyGreenstein { g } = phase(airlight.phase.kind, airlight.phase.g)? {
            error::asymmetry("phase.g", g)?;
        }
        for (s, t) in sigma_s.iter().zip(sigma_t) {
            error::not_negative("sigma_s", *s)?;
            error::not_negative("sigma_t", *t)?;
        }
        Ok(())
    })
}

queries! { AmAirlight, AmAirlightNodes;
    /// Air-light: radiance of a point light that the medium scatters once on the segment of a ray
    /// from `t0` to `t1`, towards the point `t0`. One number per channel, per unit intensity of the
    /// light on its axis: 1/length² per steradian; times W/sr it is W/(m² sr).
    ///
    ///     L = κ_s ∫ exp(−κ_t (t − t0 + D)) / D² I(θ) Φ(φ) dt,   D the distance from the light
    ///
    /// `direction` is a unit vector away from the eye, `t0` is finite, `t1` may be infinite; the
    /// radiance is 0 where `t1` ≤ `t0`. What lies in front of `t0` does not count: multiply by its
    /// transmittance. Nothing casts a shadow.
    ///
    /// Relative error below 1e-9, in single precision 1e-4, for |g| ≤ 0.95 and exponents up to 16. A
    /// ray through the light has no finite radiance: its distance is kept at 1e-150, in single
    /// precision 1e-18.
    /// Source: Pegoraro, Schott, Parker (2009), Eq. 4; method: `docs/airlight.md`.
    ///
    /// # Safety
    /// `airlight` points to one struct, `origin` and `direction` to three numbers, `radiance` to one
    /// per channel.
    am_airlight_radiance_f64 am_airlight_radiance_f32
    am_airlight_radiance_batch_f64 am_airlight_radiance_batch_f32 am_airlight_radiance_record
    |airlight: AirLight, origin: point, direction: point, t0: number, t1: number| -> (radiance)
    [] results => { results.extend(airlight.radiance(&Ray { origin, direction }, t0, t1)); }

    /// `am_airlight_radiance_f64` at the least cost that keeps the relative error `tolerance`, > 0,
    /// in every channel; and `error`, an estimate of the relative error of each.
    ///
    /// Tolerances below 1e-9, in single precision 1e-4, may not be reached. The estimate is no bound:
    /// of the rows of `airlight.json` 1 in 100 exceeds the tolerance, by a factor of 10 or less.
    /// Rays of a batch that are computed together take what the worst of them needs. A recording
    /// cannot choose: it costs what `am_airlight_radiance_record` does, and has an estimate too.
    /// Source: `docs/airlight.md`.
    ///
    /// # Safety
    /// As for `am_airlight_radiance_f64`; `error` points to one number per channel.
    am_airlight_radiance_within_f64 am_airlight_radiance_within_f32
    am_airlight_radiance_within_batch_f64 am_airlight_radiance_within_batch_f32
    am_airlight_radiance_within_record
    |airlight: AirLight, origin: point, direction: point, t0: number, t1: number,
        tolerance: number| -> (radiance, error)
    [] results => {
        let estimate = airlight.radiance_within(&Ray { origin, direction }, t0, t1, tolerance);
        results.extend(estimate.radiance);
        results.extend(estimate.error);
    }
}

/// Ways to compute air-light. Numbers are fixed for ever.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum AmAirlightMethod {
    /// Quadrature with `terms` points for each piece of the ray: 8, 16, …, 64.
    Quadrature = 0,
    /// The closed form by stable recurrences, with `terms` terms of its series.
    ClosedForm = 1,
    /// The paper's combined formulation as it is printed (Eq. 20).
    Combined = 2,
    /// The paper's first reformulation alone (Eq. 12), as it is printed.
    First = 3,
    /// The paper's second reformulation alone (Eq. 18), as it is printed.
    Second = 4,
}

/// Terms of the longest series of `am_airlight_radiance_by`.
const TERMS: usize = 20;

impl AmAirlightMethod {
    /// The method with this number, which knows so many terms.
    fn new(number: u32, terms: usize) -> Result<Self, Failure> {
        use AmAirlightMethod::{ClosedForm, Combined, First, Quadrature, Second};
        let known = [Quadrature, ClosedForm, Combined, First, Second];
        let method = known.into_iter().find(|method| *method as u32 == number);
        let method =
            method.ok_or_else(|| unknown("method must be one of am_airlight_method", number))?;
        let (good, reason) = match method {
            Quadrature => (
                (8..=64).contains(&terms) && terms % 8 == 0,
                "must be a multiple of 8 in [8, 64]",
            ),
            _ => ((1..=TERMS).contains(&terms), "must be in [1, 20]"),
        };
        if !good {
            return Err(Error::new("terms", reason, terms).into());
        }
        Ok(method)
    }

    fn radiance(
        self,
        air: &AirLight<f64>,
        ray: &Ray<f64>,
        [t0, t1]: [f64; 2],
        terms: usize,
    ) -> Vec<f64> {
        let printed = |form| {
            let middle = Expansion::Midpoint;
            published::radiance::<TERMS>(air, form, middle, ray, [t0, t1], terms)
        };
        match self {
            Self::Quadrature => quadrature::radiance_by(air, &air.phase, ray, t0, t1, terms),
            Self::ClosedForm => {
                let middle = Expansion::Midpoint;
                closed_form::radiance_of::<_, TERMS>(air, middle, ray, t0, t1, terms)
            }
            Self::Combined => printed(Form::Combined),
            Self::First => printed(Form::First),
            Self::Second => printed(Form::Second),
        }
    }
}

/// `am_airlight_radiance_batch_f64` by a method of choice, an `am_airlight_method`, with so many
/// `terms`, for comparisons: series are expanded in the middle of what lies between the foot of the
/// light and its edges. No error is promised; the closed forms need extinction, and the paper's lose
/// all digits in thick media, near the light and for short segments (`docs/airlight.md`).
///
/// # Safety
/// As for `am_airlight_radiance_batch_f64`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn am_airlight_radiance_by(
    airlight: *const AmAirlight,
    method: u32,
    terms: usize,
    n: usize,
    origin: AmArrayF64,
    direction: AmArrayF64,
    t0: AmArrayF64,
    t1: AmArrayF64,
    radiance: *mut f64,
) -> AmStatus {
    guard(|| {
        // SAFETY: promised by the caller.
        let airlight = unsafe { arg::reference(airlight, "airlight") }?;
        Model::check(airlight)?;
        let method = AmAirlightMethod::new(method, terms)?;
        origin.check(n, 3, "origin")?;
        direction.check(n, 3, "direction")?;
        t0.check(n, 1, "t0")?;
        t1.check(n, 1, "t1")?;
        arg::output(radiance, n, "radiance")?;
        let air = airlight.lift(|x| x);
        for item in 0..n {
            // SAFETY: the arrays have been checked, and the caller promises n items, and room for
            // the channels of each.
            unsafe {
                let point = |array: &AmArrayF64| std::array::from_fn(|i| array.get(item, i));
                let ray = Ray {
                    origin: point(&origin),
                    direction: point(&direction),
                };
                let segment = [t0.get(item, 0), t1.get(item, 0)];
                let channels = method.radiance(&air, &ray, segment, terms);
                let first = radiance.add(item * channels.len());
                for (k, value) in channels.into_iter().enumerate() {
                    *first.add(k) = value;
                }
            }
        }
        Ok(())
    })
}

/// A phase function of the caller: its value, 1/sr, for the cosine of the angle of scattering.
struct Callback {
    function: unsafe extern "C" fn(cosine: f64, data: *mut c_void) -> f64,
    data: *mut c_void,
}

impl PhaseFunction<f64> for Callback {
    fn value(&self, deflection: Deflection<f64>) -> f64 {
        // SAFETY: the caller vouches for the function and its data.
        unsafe { (self.function)(deflection.cos, self.data) }
    }

    // It may have a peak at either end.
    fn peaks(&self, _: f64) -> [f64; 2] {
        [0.03; 2]
    }
}

/// `am_airlight_radiance_f64` with a phase function of the caller in place of `airlight.phase`:
/// `phase(cosine, data)` is called up to 64 times for each part of the ray that the light does not
/// divide, with cosines in [−1, 1] (1 is forward). Its integral over the sphere is 1.
///
/// Relative error 1e-9 for functions as smooth as Henyey and Greenstein's with |g| ≤ 0.95.
///
/// # Safety
/// As for `am_airlight_radiance_f64`; `phase` must not unwind.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn am_airlight_radiance_with_phase(
    airlight: *const AmAirlight,
    phase: Option<unsafe extern "C" fn(cosine: f64, data: *mut c_void) -> f64>,
    data: *mut c_void,
    origin: *const f64,
    direction: *const f64,
    t0: f64,
    t1: f64,
    radiance: *mut f64,
) -> AmStatus {
    guard(|| {
        // SAFETY: promised by the caller.
        let airlight = unsafe { arg::reference(airlight, "airlight") }?;
        Model::check(airlight)?;
        let function =
            phase.ok_or_else(|| Failure::new(AmStatus::NullPointer, "phase must not be null"))?;
        arg::output(radiance, 1, "radiance")?;
        // SAFETY: promised by the caller.
        let ray = unsafe {
            Ray {
                origin: query::point(origin, "origin")?,
                direction: query::point(direction, "direction")?,
            }
        };
        let phase = Callback { function, data };
        let air = airlight.lift(|x| x);
        let results = quadrature::radiance_by(&air, &phase, &ray, t0, t1, 64);
        query::write_numbers(&results, &[radiance]);
        Ok(())
    })
}
