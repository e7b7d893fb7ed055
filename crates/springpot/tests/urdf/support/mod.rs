//! A small arm to spoil.

use springpot::model::description::{DescriptionError, DescriptionOptions, DescriptionWarningKind, RobotDescription};

/// An arm of two joints without anything to warn of.
pub(crate) const ARM: &str = r#"<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0 0 0.1" rpy="0 0 0"/>
      <mass value="2"/>
      <inertia ixx="0.3" ixy="0" ixz="0" iyy="0.4" iyz="0" izz="0.5"/>
    </inertial>
  </link>
  <link name="lower">
    <inertial>
      <mass value="1"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>
    </inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.5" rpy="0 0 0"/>
    <parent link="base"/>
    <child link="upper"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="2"/>
    <dynamics damping="0.1" friction="0.2"/>
  </joint>
  <joint name="elbow" type="prismatic">
    <origin xyz="0 0 0.4"/>
    <parent link="upper"/>
    <child link="lower"/>
    <axis xyz="1 0 0"/>
    <limit lower="0" upper="0.3" effort="50" velocity="1"/>
  </joint>
</robot>
"#;

/// The arm with `old`, which stands there once, replaced.
pub(crate) fn arm_with(old: &str, new: &str) -> String {
    assert_eq!(ARM.matches(old).count(), 1, "{old:?}");
    ARM.replace(old, new)
}

/// The arm with more in its last line.
pub(crate) fn arm_and(more: &str) -> String {
    arm_with("</robot>", &format!("{more}</robot>"))
}

pub(crate) const FLOATING: DescriptionOptions =
    DescriptionOptions { floating_base: true, ignore_mimic: false, accept_inertia: false, package_path: Vec::new() };

pub(crate) fn parse_with(text: &str, options: &DescriptionOptions) -> Result<RobotDescription, DescriptionError> {
    RobotDescription::parse(text, None, options)
}

pub(crate) fn parse(text: &str) -> RobotDescription {
    parse_with(text, &DescriptionOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Asserts that `text` is refused with exactly this message.
#[track_caller]
pub(crate) fn refused(text: &str, message: &str) {
    refused_with(text, &DescriptionOptions::default(), message);
}

/// Asserts that `text` is refused with exactly this message.
#[track_caller]
pub(crate) fn refused_with(text: &str, options: &DescriptionOptions, message: &str) {
    let error = parse_with(text, options).expect_err("this is no robot");
    assert_eq!(error.to_string(), message);
    let line = message.strip_prefix("line ").map(|rest| rest.split(',').next().unwrap().parse().unwrap());
    assert_eq!(error.line(), line);
}

/// Asserts that `text` is read with exactly these warnings.
#[track_caller]
pub(crate) fn warned(text: &str, warnings: &[(DescriptionWarningKind, &str)]) -> RobotDescription {
    warned_with(text, &DescriptionOptions::default(), warnings)
}

/// Asserts that `text` is read with exactly these warnings.
#[track_caller]
pub(crate) fn warned_with(
    text: &str,
    options: &DescriptionOptions,
    warnings: &[(DescriptionWarningKind, &str)],
) -> RobotDescription {
    let urdf = parse_with(text, options).unwrap_or_else(|error| panic!("{error}"));
    let found: Vec<_> = urdf.warnings.iter().map(|warning| (warning.kind, warning.to_string())).collect();
    let expected: Vec<_> = warnings.iter().map(|&(kind, text)| (kind, text.to_owned())).collect();
    assert_eq!(found, expected);
    urdf
}
