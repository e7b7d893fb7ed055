//! Links and joints that are not one tree.

use crate::support::{arm_and, arm_with, refused};

/// Links and fixed joints, one a line; a joint is called by its parent and its child.
fn tree(links: &str, joints: &[&str]) -> String {
    let mut text = String::from("<robot name=\"tree\">\n");
    for name in links.chars() {
        text += &format!("<link name=\"{name}\"/>\n");
    }
    for ends in joints {
        let (parent, child) = ends.split_at(1);
        text += &format!(
            "<joint name=\"{ends}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/></joint>\n"
        );
    }
    text + "</robot>"
}

#[test]
fn links_that_do_not_exist() {
    let message = "line 26, column 5: the <parent> of joint \"elbow\" is link \"uper\", which does not exist; did you \
        mean \"upper\"?";
    refused(&arm_with("<parent link=\"upper\"/>", "<parent link=\"uper\"/>"), message);
    let message = "line 27, column 5: the <child> of joint \"elbow\" is link \"hand\", which does not exist";
    refused(&arm_with("<child link=\"lower\"/>", "<child link=\"hand\"/>"), message);
    let message = "line 26, column 5: the <parent> of joint \"elbow\" is link \"\", which does not exist";
    refused(&arm_with("<parent link=\"upper\"/>", "<parent link=\"\"/>"), message);
}

#[test]
fn a_link_has_one_parent() {
    let message =
        "line 7, column 49: link \"c\" is the child of joint \"bc\" and, in line 6, of joint \"ac\"; one is allowed";
    refused(&tree("abc", &["ab", "ac", "bc"]), message);
    let message = "line 4, column 1: joint \"bb\" has link \"b\" as parent and as child";
    refused(&tree("ab", &["bb"]), message);
}

#[test]
fn a_tree_has_one_root() {
    let rest = "all but one need a joint that has them as child";
    let message =
        format!("line 31, column 1: the links are not one tree: no joint leads to \"base\" and \"lost\"; {rest}");
    refused(&arm_and("<link name=\"lost\"/>"), &message);
    let message = format!(
        "line 3, column 1: the links are not one tree: no joint leads to \"a\", \"b\", \"c\", \"d\", \"e\", \"f\" and \
            2 more; {rest}"
    );
    refused(&tree("abcdefghi", &["ai"]), &message);
}

#[test]
fn circles_are_named() {
    let rest = "carry one another in a circle; a robot is a tree";
    refused(&tree("abc", &["ab", "bc", "ca"]), &format!("line 7, column 1: the links \"a\", \"b\" and \"c\" {rest}"));
    // A circle beside the tree, with a branch on it.
    let message = format!("line 8, column 1: the links \"c\" and \"d\" {rest}");
    refused(&tree("abcde", &["ab", "dc", "cd", "ce"]), &message);
}

#[test]
fn loops_of_other_programs_are_refused() {
    let message = "line 31, column 1: <loop_joint> changes the motion of the robot and is not supported";
    refused(&arm_and("<loop_joint name=\"l\" type=\"revolute\"/>"), message);
}
