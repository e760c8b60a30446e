//! Questions to a planet: altitudes, and where rays meet the ground and the top of the
//! atmosphere.

use super::array::Array;
use super::query::{
    self, Model, RecordedModel, argument_check, argument_type, argument_value, queries,
};
use super::{AmArrayF32, AmArrayF64, AmHostTable, AmNode, AmStatus, Failure, arg, guard};
use crate::error;
use crate::geometry::Ray;
use crate::geometry::planet::Sphere;
use crate::real::Real;
use crate::real::lanes::{F32Lanes, F64Lanes, Lanes};
use crate::real::node::Node;

/// The sphere that altitudes are counted from. In single precision altitudes are best known
/// where the origin of coordinates is on the surface and the centre on an axis.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmPlanet {
    /// Centre, a point.
    pub center: [f64; 3],
    /// Radius, length > 0.
    pub radius: f64,
}

/// A planet whose centre and radius are slots of a host's tape.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AmPlanetNodes {
    /// Slots of the centre.
    pub center: [AmNode; 3],
    /// Slot of the radius.
    pub radius: AmNode,
}

impl Model for AmPlanet {
    type In<R: Real> = Sphere<R>;

    fn check(&self) -> Result<(), Failure> {
        error::finite_vector("center", self.center)?;
        error::positive("radius", self.radius)?;
        Ok(())
    }

    fn lift<R: Real>(&self, lift: impl Fn(f64) -> R) -> Sphere<R> {
        Sphere {
            center: self.center.map(&lift),
            radius: lift(self.radius),
        }
    }
}

impl RecordedModel for AmPlanetNodes {
    type In<R: Real> = Sphere<R>;

    unsafe fn nodes<'h>(&self, host: &'h AmHostTable) -> Result<Sphere<Node<'h>>, Failure> {
        Ok(Sphere {
            center: self.center.map(|slot| Node::new(host, slot)),
            radius: Node::new(host, self.radius),
        })
    }
}

/// Checks a planet. The questions below check it as well.
///
/// # Safety
/// `planet` points to one struct.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn am_planet_check(planet: *const AmPlanet) -> AmStatus {
    // SAFETY: promised by the caller.
    guard(|| Model::check(unsafe { arg::reference(planet, "planet") }?))
}

queries! { AmPlanet, AmPlanetNodes;
    /// Altitude of a point above the surface: a length, negative below it.
    ///
    /// # Safety
    /// `planet` points to one struct, `point` to three numbers, `altitude` to one.
    am_planet_altitude_f64 am_planet_altitude_f32
    am_planet_altitude_batch_f64 am_planet_altitude_batch_f32 am_planet_altitude_record
    |planet: Sphere, point: point| -> (altitude)
    [] results => { results.push(planet.altitude(point)); }

    /// Cosine of the zenith angle of the horizon that is seen from a point: rays that lead
    /// further down hit the planet. 0 on the surface and below it.
    ///
    /// # Safety
    /// `planet` points to one struct, `point` to three numbers, `cos_zenith` to one.
    am_planet_horizon_f64 am_planet_horizon_f32
    am_planet_horizon_batch_f64 am_planet_horizon_batch_f32 am_planet_horizon_record
    |planet: Sphere, point: point| -> (cos_zenith)
    [] results => { results.push(planet.horizon(point)); }

    /// Distance at which a ray enters the planet, a length ≥ 0; infinite if it never does.
    /// From the surface or below it, a ray that leads down is in at once, one that leads up
    /// leaves. `direction` is a unit vector.
    ///
    /// # Safety
    /// `planet` points to one struct, `origin` and `direction` to three numbers, `t` to one.
    am_planet_hit_f64 am_planet_hit_f32
    am_planet_hit_batch_f64 am_planet_hit_batch_f32 am_planet_hit_record
    |planet: Sphere, origin: point, direction: point| -> (t)
    [] results => { results.push(planet.hit(&Ray { origin, direction })); }

    /// Where a ray is below the shell at an altitude, for example inside an atmosphere that
    /// ends there: the distances of entrance, 0 if it starts inside, and exit; infinite both
    /// if it never is. `direction` is a unit vector.
    ///
    /// # Safety
    /// `planet` points to one struct, `origin` and `direction` to three numbers, `enter` and
    /// `leave` to one.
    am_planet_shell_f64 am_planet_shell_f32
    am_planet_shell_batch_f64 am_planet_shell_batch_f32 am_planet_shell_record
    |planet: Sphere, origin: point, direction: point, altitude: number| -> (enter, leave)
    [] results => {
        results.extend(<[R; 2]>::from(planet.shell(&Ray { origin, direction }, altitude)));
    }
}
