//! The keys of a whole scenario, above the tables that it holds.

use crate::figures::FIGURE;
use crate::keys::MOTION;
use crate::keys::{
    DATA, DESIGN, ELEMENT, EVENT, FIT, Keys, MAX_BLOCKS, METRIC, Need, OUTPUT, PARAMETER, ROBOT, SENSITIVITY, SOLVER,
    SWEEP, Shape, TIME, key,
};

/// The whole scenario.
pub(crate) static SCENARIO: Keys = Keys {
    words: "A Springpot scenario.",
    keys: &[
        key("title", Shape::Text, Need::Optional, "Title, shown by check and in run.json."),
        key("constants", Shape::Scalars, Need::Optional, "Numbers by name, for every expression."),
        key(
            "robot",
            Shape::Table(&ROBOT),
            Need::Required("[robot] with urdf = \"arm.urdf\", or a [[robot.body]] for each body"),
            "Gravity, bodies or a URDF file, gripper.",
        ),
        key("element", Shape::Tables(&ELEMENT, None), Need::Optional, "Materials between two points."),
        key("motion", Shape::Table(&MOTION), Need::Kind, "What moves the robot."),
        key(
            "event",
            Shape::Tables(&EVENT, None),
            Need::Optional,
            "What is watched in forward runs, and what happens then.",
        ),
        key("metric", Shape::Tables(&METRIC, None), Need::Optional, "Numbers that say how good the run is."),
        key(
            "time",
            Shape::Table(&TIME),
            Need::Required("[time] with end = \"10 s\" and output_step = \"10 ms\""),
            "Duration and rows.",
        ),
        key("solver", Shape::Table(&SOLVER), Need::Optional, "Accuracy and steps."),
        key(
            "sweep",
            Shape::Tables(&SWEEP, Some(MAX_BLOCKS)),
            Need::Optional,
            "Parameters to vary; several blocks make a grid.",
        ),
        key("parameter", Shape::Tables(&PARAMETER, None), Need::Optional, "Numbers that may be changed."),
        key("sensitivity", Shape::Table(&SENSITIVITY), Need::Optional, "Derivatives of the columns."),
        key("data", Shape::Tables(&DATA, None), Need::Optional, "Measurements, for `springpot fit`."),
        key("fit", Shape::Table(&FIT), Need::Optional, "How parameters are fitted to them."),
        key("design", Shape::Table(&DESIGN), Need::Optional, "What parameters are moved for."),
        key("figure", Shape::Tables(&FIGURE, None), Need::Optional, "Figures to draw."),
        key("output", Shape::Table(&OUTPUT), Need::Optional, "What is written."),
    ],
};
