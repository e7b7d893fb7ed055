//! Places and attitudes.

use super::error::DescriptionError;
use super::given::{Given, Reader};
use super::settings::Settings;
use crate::spatial::{Placement, Rotation, Vec3};

/// The ways to write an attitude; of an element's own and its class's the element's counts.
pub(super) const WAYS: [&str; 5] = ["axisangle", "xyaxes", "zaxis", "euler", "quat"];

/// Vectors shorter than this have no direction.
const SHORT: f64 = 1e-10;

/// `pos` and the attitude beside it.
pub(super) fn placement(
    reader: &Reader<'_>,
    given: &Given<'_>,
    settings: &Settings,
) -> Result<Placement, DescriptionError> {
    let translation = given.array(reader, "pos")?.map_or(Vec3::ZERO, Vec3);
    Ok(Placement { rotation: attitude(reader, given, settings)?, translation })
}

/// The attitude; none where nothing is written.
pub(super) fn attitude(
    reader: &Reader<'_>,
    given: &Given<'_>,
    settings: &Settings,
) -> Result<Rotation, DescriptionError> {
    let own = WAYS.into_iter().filter(|way| given.element.attribute(way).is_some());
    let own: Vec<&str> = own.collect();
    if let [first, second, ..] = own[..] {
        let why = format!("has {first} and {second}; one attitude is enough");
        return Err(reader.refuse(given.element.at, given.owner, why));
    }
    let way = own.first().copied().or_else(|| WAYS.into_iter().find(|way| given.attribute(way).is_some()));
    let no_direction = |name: &str| {
        let at = given.attribute(name).map_or(given.element.at, |attribute| attribute.at);
        Err(reader.refuse(at, given.owner, format!("{name} of <{}> has no direction", given.element.tag)))
    };
    match way {
        Some("quat") => {
            let [w, x, y, z] = given.array(reader, "quat")?.unwrap_or([1.0, 0.0, 0.0, 0.0]);
            let norm = (w * w + x * x + y * y + z * z).sqrt();
            if norm < SHORT {
                return no_direction("quat");
            }
            Ok(Rotation::from_quaternion_components([x, y, z, w].map(|c| c / norm)))
        }
        Some("axisangle") => {
            let [x, y, z, angle] = given.array(reader, "axisangle")?.unwrap_or_default();
            let axis = Vec3([x, y, z]);
            if axis.norm() < SHORT {
                return no_direction("axisangle");
            }
            Ok(Rotation::from_axis_angle(direction(axis), settings.angle(angle)))
        }
        Some("xyaxes") => {
            let [a, b, c, d, e, f] = given.array(reader, "xyaxes")?.unwrap_or_default();
            let (x, y) = (Vec3([a, b, c]), Vec3([d, e, f]));
            if x.norm() < SHORT {
                return no_direction("xyaxes");
            }
            let x = direction(x);
            let along = x.dot(y);
            let y = y - Vec3(x.0.map(|x| along * x));
            if y.norm() < SHORT {
                return no_direction("xyaxes");
            }
            Ok(of_columns([x, direction(y)]))
        }
        Some("zaxis") => {
            let axis = given.array(reader, "zaxis")?.map_or(Vec3::ZERO, Vec3);
            if axis.norm() < SHORT { no_direction("zaxis") } else { Ok(along(axis)) }
        }
        Some("euler") => {
            let angles: [f64; 3] = given.array(reader, "euler")?.unwrap_or_default();
            let mut rotation = Rotation::IDENTITY;
            for (axis, angle) in settings.sequence.into_iter().zip(angles) {
                let about = Vec3(['x', 'y', 'z'].map(|c| f64::from(u8::from(axis.eq_ignore_ascii_case(&c)))));
                let turn = Rotation::from_axis_angle(about, settings.angle(angle));
                rotation = if axis.is_ascii_lowercase() { rotation * turn } else { turn * rotation };
            }
            Ok(rotation)
        }
        _ => Ok(Rotation::IDENTITY),
    }
}

/// The shortest turn of the z axis into that direction; half a turn is one about x.
pub(super) fn along(axis: Vec3) -> Rotation {
    let axis = direction(axis);
    let across = Vec3([0.0, 0.0, 1.0]).cross(axis);
    let sine = across.norm();
    let about = if sine < SHORT { Vec3([1.0, 0.0, 0.0]) } else { direction(across) };
    let sine = if sine < SHORT { 0.0 } else { sine };
    Rotation::from_axis_angle(about, sine.atan2(axis.0[2]))
}

/// Of length 1.
pub(super) fn direction(v: Vec3) -> Vec3 {
    let norm = v.norm();
    Vec3(v.0.map(|x| x / norm))
}

fn of_columns([x, y]: [Vec3; 2]) -> Rotation {
    let z = x.cross(y);
    Rotation([0, 1, 2].map(|k| [x.0[k], y.0[k], z.0[k]]))
}

/// Roll, pitch and yaw, which give the rotation back to its last digits, also near a pitch of a quarter turn.
pub(super) fn rpy(rotation: &Rotation) -> [f64; 3] {
    let Rotation(r) = rotation;
    let yaw = r[1][0].atan2(r[0][0]);
    let (sin, cos) = yaw.sin_cos();
    let pitch = (-r[2][0]).atan2(cos * r[0][0] + sin * r[1][0]);
    let roll = (sin * r[0][2] - cos * r[1][2]).atan2(cos * r[1][1] - sin * r[0][1]);
    [roll, pitch, yaw]
}

#[cfg(test)]
mod tests {
    use super::{along, rpy};
    use crate::spatial::{Rotation, Vec3};

    #[test]
    fn angles_give_rotations_back() {
        let near = std::f64::consts::FRAC_PI_2;
        for pitch in [0.3, near, -near, near - 1e-9, near - 3e-8, 2.0] {
            for (roll, yaw) in [(0.0, 0.0), (0.7, -2.0), (-3.1, 1.0)] {
                let rotation = Rotation::from_rpy([roll, pitch, yaw]);
                let back = Rotation::from_rpy(rpy(&rotation));
                let pairs = rotation.0.as_flattened().iter().zip(back.0.as_flattened());
                let off = pairs.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
                assert!(off < 1e-15, "{roll} {pitch} {yaw}: {off:e}");
            }
        }
        for axis in [[0.0, 0.0, -2.0], [0.1, 0.0, 0.3], [0.0, 0.0, 1.0]] {
            let turned = along(Vec3(axis)).column(2);
            assert!((turned.dot(Vec3(axis)) - Vec3(axis).norm()).abs() < 1e-15, "{axis:?}");
        }
    }
}
