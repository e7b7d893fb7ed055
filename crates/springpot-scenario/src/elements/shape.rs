//! What an element acts along: points, a joint, two frames.

use crate::elements::plan::{FramePlan, ShapePlan};
use crate::keys::{ANCHOR, BETWEEN, BUSHING, END};
use crate::reader::{Field, Read, Table, all};
use crate::robot::Robot;
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind};
use springpot::elements::{Bushing, Cable, CableError, Component, Joint, JointMeasureError, Line, Measure};
use springpot::model::{Anchor, Frame, Model, Site, Space};
use springpot::spatial::Rotation;

/// A measure, and what the scenario says of it.
pub(super) struct Shape {
    pub(super) measure: Measure,
    pub(super) plan: ShapePlan,
    /// Where its points stand, or its joint.
    pub(super) ends: Vec<Place>,
}

impl ShapePlan {
    /// The measure on a robot; `None` where it has none there.
    pub(crate) fn measure(&self, model: &Model) -> Option<Measure> {
        let site = |anchor: &Anchor| model.resolve(anchor).ok();
        Some(match self {
            Self::Points(points) => match &points[..] {
                [from, to] => Line { from: site(from)?, to: site(to)? }.into(),
                points => Cable::new(points.iter().map(site).collect::<Option<Vec<_>>>()?).ok()?.into(),
            },
            Self::Joint(joint) => Joint::named(model, joint).ok()?.into(),
            Self::Bushing { from, to, component } => {
                let frame = |plan: &FramePlan| model.resolve_frame(&plan.anchor, &Rotation::from_rpy(plan.rpy)).ok();
                Bushing::new(model, frame(from)?, frame(to)?, *component).into()
            }
        })
    }

    /// The same shape between other points: of frames their origins.
    pub(crate) fn with_anchors(&self, anchors: &[Anchor]) -> Self {
        match (self, anchors) {
            (Self::Points(_), anchors) => Self::Points(anchors.to_vec()),
            (Self::Bushing { from, to, component }, [first, second]) => Self::Bushing {
                from: FramePlan { anchor: *first, ..*from },
                to: FramePlan { anchor: *second, ..*to },
                component: *component,
            },
            _ => self.clone(),
        }
    }
}

/// A body by the name that the file gives it, and what is said of it.
type Named<T> = (String, T);

/// Reads `from`, `via` and `to`.
pub(super) fn between_points(table: &Table<'_>, robot: &Robot) -> Read<Shape> {
    let from = end(table, "from", BETWEEN, robot);
    let to = end(table, "to", BETWEEN, robot);
    let via = table.get("via").map_or(Ok(Vec::new()), |field| {
        let items = field.items("an array of points: [{ body = \"NAME\", point = [x, y, z] }, …]")?;
        all(items.iter().map(|item| robot.anchor(&item.table(&ANCHOR)?)))
    });
    if let (Ok(from), Ok(to), Ok(via)) = (&from, &to, &via)
        && via.is_empty()
    {
        apart(table, robot, [(&from.0, from.1.anchor), (&to.0, to.1.anchor)]);
    }
    let ends = [from?, to?];
    let via: Vec<Named<Anchor>> = via?;
    let site = |anchor: &Anchor| robot.model().resolve(anchor).expect("an anchor that was read");
    let [from, to] = [&ends[0].1.anchor, &ends[1].1.anchor];
    let points: Vec<Anchor> = [*from].into_iter().chain(via.iter().map(|(_, anchor)| *anchor)).chain([*to]).collect();
    let plan = ShapePlan::Points(points);
    let places = places_of(table);
    if via.is_empty() {
        return Ok(Shape { measure: Line { from: site(from), to: site(to) }.into(), plan, ends: places });
    }
    let ShapePlan::Points(points) = &plan else { unreachable!("made of points") };
    let sites: Vec<Site> = points.iter().map(site).collect();
    let cable = Cable::new(sites).map_err(|error| {
        let place = table.get("via").map_or(&table.node.place, |field| &field.node.place);
        let (why, help) = match error {
            CableError::Coincident { segment } => {
                let end = |k: usize| match k {
                    0 => "`from`".to_owned(),
                    k if k == points.len() - 1 => "`to`".to_owned(),
                    k => format!("point {k} of `via`"),
                };
                let why = format!(
                    "{} and {} are one point of one body: segment {segment} of the cable has no length",
                    end(segment - 1),
                    end(segment)
                );
                (why, "leave one of them out, or move it")
            }
            other => (other.to_string(), "let it run over two bodies that move against each other"),
        };
        let message = format!("{}: {why}", table.what);
        table.ctx.refuse(place.refuse(RefusalKind::Rule, message).help(help))
    })?;
    Ok(Shape { measure: cable.into(), plan, ends: places })
}

/// Where the points of an element stand, from one end to the other.
fn places_of(table: &Table<'_>) -> Vec<Place> {
    let one = |key: &'static str| table.get(key).map(|field| field.node.place.clone());
    let via = table.get("via").and_then(|field| field.node.items()).unwrap_or_default();
    one("from").into_iter().chain(via.iter().map(|item| item.place.clone())).chain(one("to")).collect()
}

/// Reads `joint`.
pub(super) fn on_joint(table: &Table<'_>, robot: &Robot) -> Read<Shape> {
    let field = table.require("joint")?;
    let name = field.text()?;
    let model = robot.model();
    let joint = Joint::named(model, name).map_err(|error| match error {
        JointMeasureError::Kind { .. } | JointMeasureError::Several { .. } => {
            field.refuse(RefusalKind::Rule, format!("is {name:?}: {error}"), other_joints(robot))
        }
        _ if let Some((joint, kind)) = free_joint(name, robot) => {
            let message = format!("is {name:?}, but joint {joint:?} is {kind}: an element acts on a coordinate that is a number of its own");
            field.refuse(RefusalKind::Rule, message, other_joints(robot))
        }
        _ => {
            let known = model.joint_names().iter().map(String::as_str);
            let message = format!("names no joint: {:?}", crate::text::document::shorten(name));
            field.refuse(RefusalKind::UnknownName, message, Some(names::suggest(name, known)))
        }
    })?;
    Ok(Shape { measure: joint.into(), plan: ShapePlan::Joint(name.to_owned()), ends: vec![field.node.place.clone()] })
}

/// The joint that turns freely, and its kind, of whose numbers this is one.
fn free_joint<'a>(name: &'a str, robot: &Robot) -> Option<(&'a str, &'static str)> {
    let (joint, _) = name.rsplit_once('.')?;
    let model = robot.model();
    let space = model.joint_space(model.joint_index(joint)?);
    let labels = [model.q_labels(), model.v_labels()];
    let is_part = space.quaternion().is_some() && labels.iter().flatten().any(|label| label.name == name);
    is_part.then(|| (joint, if space == Space::Pose { "floating" } else { "spherical" }))
}

/// The joints that an element can act on.
fn other_joints(robot: &Robot) -> Option<String> {
    let model = robot.model();
    let one_degree = (0..model.joint_count()).filter(|&j| model.joint_space(j).dimension().is_some());
    let names: Vec<&str> = one_degree.map(|j| model.joint_names()[j].as_str()).collect();
    (!names.is_empty()).then(|| format!("joints with one coordinate are {}", names::list(names)))
}

/// The frames of a bushing.
pub(super) struct Frames {
    from: (FramePlan, Frame),
    to: (FramePlan, Frame),
    ends: Vec<Place>,
}

/// Reads `from` and `to` of a bushing.
pub(super) fn frames(table: &Table<'_>, robot: &Robot) -> Read<Frames> {
    let from = end(table, "from", BUSHING, robot);
    let to = end(table, "to", BUSHING, robot);
    if let (Ok((first, from)), Ok((second, to))) = (&from, &to) {
        apart(table, robot, [(first, from.anchor), (second, to.anchor)]);
    }
    let resolved = |(_, plan): Named<FramePlan>| {
        let frame = robot.model().resolve_frame(&plan.anchor, &Rotation::from_rpy(plan.rpy));
        (plan, frame.expect("an anchor that was read"))
    };
    Ok(Frames { from: resolved(from?), to: resolved(to?), ends: places_of(table) })
}

impl Frames {
    pub(super) fn shape(&self, robot: &Robot, component: Component) -> Shape {
        let Self { from: (from, first), to: (to, second), ends } = self;
        let measure = Bushing::new(robot.model(), *first, *second, component).into();
        let ends = ends.clone();
        Shape { measure, plan: ShapePlan::Bushing { from: *from, to: *to, component }, ends }
    }
}

/// Reads an end: a point, of a bushing a frame.
fn end(table: &Table<'_>, key: &'static str, kind: &'static str, robot: &Robot) -> Read<Named<FramePlan>> {
    let field: Field<'_> = table.require(key)?;
    let turned = |key: &str| {
        let message = format!("`{key}` of {field} belongs to the frames of a bushing: a point has no axes");
        END.is_of_a_kind(key).then_some((RefusalKind::Rule, message))
    };
    let end = Table::of_kind(field.ctx, field.node, field.to_string(), (&END, kind), turned)?;
    let rpy = if kind == BUSHING { end.vector("rpy") } else { Ok([0.0; 3]) };
    let (name, anchor) = robot.anchor(&end)?;
    Ok((name, FramePlan { anchor, rpy: rpy? }))
}

/// Notes where two ends move together.
fn apart(table: &Table<'_>, robot: &Robot, [(first, from), (second, to)]: [(&String, Anchor); 2]) {
    if robot.carrier(from.body) != robot.carrier(to.body) {
        return;
    }
    let why = if first == second {
        format!("has both ends on {first:?}")
    } else if from.body == to.body {
        format!("has both ends on the world, which is also called {:?}", if first == "world" { second } else { first })
    } else {
        format!("joins {first:?} and {second:?}, which fixed joints hold together")
    };
    let place = table.get("to").map_or(&table.node.place, |field| &field.node.place);
    let what =
        if table.get("bushing").is_some() { "frames cannot move against each other" } else { "length cannot change" };
    let message = format!("{} {why}: its {what}", table.what);
    table.ctx.refuse(place.refuse(RefusalKind::Rule, message).help("join two bodies that move against each other"));
}
