//! What was left out of a URDF file or assumed.

use std::collections::BTreeMap;
use std::fmt;

use super::error::Owner;

/// Something that was not used, or assumed, at one or more places of the file.
///
/// `Display` is one line: what it is and the first places; [`UrdfWarning::places`] has all of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UrdfWarning {
    /// What it is.
    pub kind: UrdfWarningKind,
    /// Where, in the order of the file; at least one.
    pub places: Vec<UrdfPlace>,
}

/// Where a warning applies.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UrdfPlace {
    /// The link or joint.
    pub owner: Owner,
    /// Line of the file, from 1.
    pub line: usize,
    /// The element, file or value; empty where the kind says it all.
    pub what: String,
}

/// The kinds of warning; what concerns the motion comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum UrdfWarningKind {
    /// A link on a moving joint has no `<inertial>`; it is taken as massless.
    NoInertial,
    /// A link on a moving joint has the mass 0.
    ZeroMass,
    /// The largest principal moment of a link that moves is above the sum of the others by more than 1e-9 of itself. The
    /// tensor is used as it is.
    TriangleInequality,
    /// A moving joint has no `<axis>`; 1 0 0 is assumed, as the format says.
    NoAxis,
    /// The `<axis>` of a moving joint is not of length 1, by more than 1e-3; its direction is used.
    AxisLength,
    /// A revolute or prismatic joint has no `<limit>`; it is taken as unlimited.
    NoLimit,
    /// A `<limit>` is incomplete: lower and upper are then 0, as the format says, effort and velocity unlimited.
    IncompleteLimit,
    /// A lower limit above the upper one, or a largest effort or velocity below 0: taken as unlimited.
    SenselessLimit,
    /// A `<mimic>` that was not applied because the caller asked so; the joint has its own coordinate.
    MimicIgnored,
    /// An `<axis>`, `<dynamics>`, `<limit>` or `<mimic>` of a floating joint, which has no use for it.
    OfFloatingJoint,
    /// Something inside `<gazebo>` that changes the motion in that simulator.
    InSimulator,
    /// The robot has no name.
    NoName,
    /// Elements that are not known.
    UnknownElement,
    /// Attributes that are not known.
    UnknownAttribute,
    /// Text between elements.
    StrayText,
    /// Files of shapes that are not found. The dynamics need none.
    MeshNotFound,
    /// What is known and has no part in the dynamics.
    NotUsed,
}

impl UrdfWarningKind {
    /// What it says before the places.
    fn lead(self) -> &'static str {
        match self {
            Self::NoInertial => "no <inertial>, taken as massless",
            Self::ZeroMass => "mass 0",
            Self::TriangleInequality => "inertia that no distribution of mass has, used as it is",
            Self::NoAxis => "no <axis>, 1 0 0 assumed",
            Self::AxisLength => "<axis> not of length 1, its direction is used",
            Self::NoLimit => "no <limit>, taken as unlimited",
            Self::IncompleteLimit => "incomplete <limit>",
            Self::SenselessLimit => "senseless <limit>, taken as unlimited",
            Self::MimicIgnored => "<mimic> not applied, own coordinate instead",
            Self::OfFloatingJoint => "not used, the joint is floating",
            Self::InSimulator => "not used, though it changes the motion in Gazebo",
            Self::NoName => "no name",
            Self::UnknownElement | Self::UnknownAttribute => "not known, not used",
            Self::StrayText => "text between elements, not used",
            Self::MeshNotFound => "mesh files not found (the dynamics need none)",
            Self::NotUsed => "not used",
        }
    }

    /// Whether the number of places says more than their names.
    fn is_counted(self) -> bool {
        matches!(
            self,
            Self::InSimulator | Self::UnknownElement | Self::UnknownAttribute | Self::StrayText | Self::NotUsed
        )
    }
}

impl UrdfWarning {
    /// Line of the first place, from 1.
    pub fn line(&self) -> usize {
        self.places[0].line
    }
}

impl fmt::Display for UrdfWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        /// Groups and places beyond these are only counted.
        const GROUPS: usize = 12;
        const PLACES: usize = 3;
        write!(f, "{}: ", self.kind.lead())?;
        let groups = self.groups();
        for (k, places) in groups.iter().take(GROUPS).enumerate() {
            let first = places[0];
            if k > 0 {
                f.write_str(if self.kind.is_counted() { ", " } else { "; " })?;
            }
            if self.kind.is_counted() && places.len() > 1 {
                write!(f, "{} {} (from line {})", places.len(), first.what, first.line)?;
                continue;
            }
            for (k, place) in places.iter().take(PLACES).enumerate() {
                let separator = if k > 0 { ", " } else { "" };
                match (place.what.is_empty() || k > 0, &place.owner) {
                    (true, owner) => write!(f, "{separator}{owner} (line {})", place.line)?,
                    (false, Owner::Robot) => write!(f, "{} (line {})", place.what, place.line)?,
                    (false, owner) => write!(f, "{} of {owner} (line {})", place.what, place.line)?,
                }
            }
            if places.len() > PLACES {
                write!(f, " and {} more", places.len() - PLACES)?;
            }
        }
        if groups.len() > GROUPS {
            write!(f, " and {} more", groups.len() - GROUPS)?;
        }
        Ok(())
    }
}

impl UrdfWarning {
    /// The places of the same `what`, in the order of the first of each.
    fn groups(&self) -> Vec<Vec<&UrdfPlace>> {
        let mut index = std::collections::HashMap::new();
        let mut groups: Vec<Vec<&UrdfPlace>> = Vec::new();
        for place in &self.places {
            let at = *index.entry(place.what.as_str()).or_insert(groups.len());
            if at == groups.len() {
                groups.push(Vec::new());
            }
            groups[at].push(place);
        }
        groups
    }
}

/// Warnings while they are gathered.
#[derive(Debug, Default)]
pub(super) struct Warnings(BTreeMap<UrdfWarningKind, Vec<UrdfPlace>>);

impl Warnings {
    pub(super) fn add(&mut self, kind: UrdfWarningKind, owner: &Owner, line: usize, what: impl Into<String>) {
        self.0.entry(kind).or_default().push(UrdfPlace { owner: owner.clone(), line, what: what.into() });
    }

    /// By kind; within one in the order of the file.
    pub(super) fn finish(self) -> Vec<UrdfWarning> {
        let in_order = |(kind, mut places): (_, Vec<UrdfPlace>)| {
            places.sort_by_key(|place| place.line);
            UrdfWarning { kind, places }
        };
        self.0.into_iter().map(in_order).collect()
    }
}
