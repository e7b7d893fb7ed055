use super::*;

#[test]
fn a_cube_is_a_cube_in_every_format() {
    let files: [(&str, Vec<u8>); 4] = [
        ("cube.DAE", cubes(&[""]).into()),
        ("cube.obj", cube_obj().into()),
        ("cube.stl", cube_stl_text().into()),
        ("cube.STL", cube_stl_bytes()),
    ];
    for (name, bytes) in files {
        let parts = read_as(name, bytes).unwrap();
        assert_eq!((parts.len(), triangles(&parts)), (1, 12), "{name}");
        assert_eq!(parts[0].surface.vertices.len(), 8, "{name}");
        assert_eq!(extent(&parts), ([0.0; 3], [1.0; 3]), "{name}");
        // All faces look outwards: the volume is positive, and that of the cube.
        let at = |corner: u32| parts[0].surface.vertices[corner as usize];
        let volume: f32 = parts[0]
            .surface
            .triangles
            .iter()
            .map(|[a, b, c]| {
                let ([ax, ay, az], [bx, by, bz], [cx, cy, cz]) = (at(*a), at(*b), at(*c));
                (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0
            })
            .sum();
        assert!((volume - 1.0).abs() < 1e-6, "{name} {volume}");
    }
}

#[test]
fn three_parts_keep_their_places_and_their_colours() {
    let file = cubes(&["", "<translate>10 0 0</translate>", "<matrix>1 0 0 20 0 2 0 0 0 0 1 0 0 0 0 1</matrix>"]);
    let parts = read_as("three.dae", file).unwrap();
    assert_eq!(
        parts.iter().map(|part| part.color).collect::<Vec<_>>(),
        [Some([204, 51, 26]), Some([255; 3]), Some([26, 51, 230])]
    );
    for (part, (x, tall)) in parts.iter().zip([(20.0, 2.0), (10.0, 1.0), (0.0, 1.0)]) {
        let surface = &part.surface;
        assert_eq!(surface.triangles.len(), 12);
        assert_eq!(extent(std::slice::from_ref(part)), ([x, 0.0, 0.0], [x + 1.0, tall, 1.0]));
        // No triangle is longer than its own part.
        for triangle in &surface.triangles {
            let corners = triangle.map(|corner| surface.vertices[corner as usize]);
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let edge: f32 = (0..3).map(|k| (corners[a][k] - corners[b][k]).powi(2)).sum();
                assert!(edge <= 2.0 + tall * tall, "{edge}");
            }
        }
    }
}

#[test]
fn transformations_act_in_their_order() {
    // About z by a quarter turn, then along the new x, which is the old y; twice as large; in millimetres.
    let steps = "<rotate>0 0 1 90</rotate><translate>3 0 0</translate><scale>2 2 2</scale>";
    let file = cubes(&[steps]).replace("meter=\"1\"", "meter=\"0.001\"");
    let (low, high) = extent(&read_as("a.dae", &file).unwrap());
    for (found, wanted) in low.into_iter().chain(high).zip([-0.002, 0.003, 0.0, 0.0, 0.005, 0.002]) {
        assert!((found - wanted).abs() < 1e-8, "{low:?} {high:?}");
    }
    // What is up comes to lie along z, unless MeshLab says it.
    for (up, wanted) in
        [("Y_UP", [-0.002, -0.002, 0.003, 0.0, 0.0, 0.005]), ("X_UP", [-0.005, -0.002, -0.002, -0.003, 0.0, 0.0])]
    {
        let turned = file.replace("Z_UP", up);
        let (low, high) = extent(&read_as("a.dae", &turned).unwrap());
        for (found, wanted) in low.into_iter().chain(high).zip(wanted) {
            assert!((found - wanted).abs() < 1e-8, "{up}: {low:?} {high:?}");
        }
        let tool = "<asset><contributor><authoring_tool>VCGLib | MeshLab</authoring_tool></contributor>";
        assert_eq!(
            extent(&read_as("a.dae", turned.replace("<asset>", tool)).unwrap()),
            extent(&read_as("a.dae", &file).unwrap())
        );
    }
    // Nodes within nodes, and instances of them.
    let nested = cubes(&["<translate>1 0 0</translate>"]).replace(
        "<visual_scene id=\"s\">",
        "<visual_scene id=\"s\"><node><translate>0 5 0</translate><instance_node url=\"#n0\"/><node><scale>-1 1 1</scale><instance_node url=\"#n0\"/></node></node>",
    );
    let parts = read_as("b.dae", nested).unwrap();
    assert_eq!((triangles(&parts), extent(&parts)), (36, ([-2.0, 0.0, 0.0], [2.0, 6.0, 1.0])));
}

#[test]
fn polygons_of_all_kinds() {
    let mesh = |primitive: &str| {
        format!(
            "<COLLADA><library_geometries><geometry><mesh><source id=\"p\"><float_array>0 0 0 1 0 0 1 1 0 0 1 0 2 2 2</float_array></source>\
             <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>{primitive}</mesh></geometry></library_geometries></COLLADA>"
        )
    };
    let input = "<input semantic=\"VERTEX\" source=\"#v\"/>";
    for (primitive, count) in [
        (format!("<polylist count=\"2\">{input}<vcount>4 3</vcount><p>0 1 2 3 0 1 4</p></polylist>"), 3),
        (format!("<polygons>{input}<p>0 1 2 3</p><p>0 1 4</p><ph><p>0 1 2</p><h>1 2 3</h></ph></polygons>"), 4),
        (format!("<tristrips>{input}<p>0 1 3 2</p></tristrips>"), 2),
        (format!("<trifans>{input}<p>0 1 2 3 4</p></trifans>"), 3),
        (format!("<triangles>{input}<p>0 1 2</p></triangles><lines count=\"1\">{input}<p>0 1</p></lines>"), 1),
    ] {
        assert_eq!(triangles(&read_as("a.dae", mesh(&primitive)).unwrap()), count, "{primitive}");
    }
    let short = |primitive: &str| {
        refusal("a.dae", mesh(&format!("<{primitive}</p></{}>", primitive.split([' ', '>']).next().unwrap())))
    };
    let more = "a mesh tells of more corners than are there";
    assert_eq!(short(&format!("triangles count=\"2\">{input}<p>0 1 2 0 1")), more);
    assert_eq!(short(&format!("triangles count=\"4294967295\">{input}<p>0 1 2")), more);
    assert_eq!(short(&format!("polylist count=\"1\">{input}<vcount>99999999999</vcount><p>0 1 2")), more);
    assert_eq!(short(&format!("triangles count=\"1\">{input}<p>0 1 5")), "a corner names a point that is not there");
    assert_eq!(
        short("triangles count=\"1\"><input semantic=\"VERTEX\" offset=\"4000000000\"/><p>0 1 2"),
        "an offset is none, or too large"
    );
    assert_eq!(short("triangles count=\"1\"><p>0 1 2"), "corners do not say which point they are");
}

#[test]
fn obj_takes_colours_of_its_own_folder_alone() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    fs::create_dir_all(at("robot/meshes")).unwrap();
    fs::write(at("secret.mtl"), "newmtl blue\nKd 1 0 0\n").unwrap();
    fs::write(at("robot/own.mtl"), "newmtl blue\nKd 0 0 1\n").unwrap();
    let color = |library: &str| {
        let path = at("robot/meshes/cube.obj");
        fs::write(&path, cube_obj().replace("cube.mtl", library)).unwrap();
        let parts = read(&MeshFile { path, folder: at("robot") }).unwrap();
        assert_eq!(triangles(&parts), 12, "{library}");
        parts[0].color
    };
    assert_eq!(color("../own.mtl"), Some([0, 0, 255]));
    let absolute = at("secret.mtl").display().to_string();
    for outside in ["../../secret.mtl", &absolute, "none.mtl", "/dev/zero", "/etc/passwd", "/dev/stdin", ".", ""] {
        assert_eq!(color(outside), None, "{outside}");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(at("secret.mtl"), at("robot/meshes/link.mtl")).unwrap();
        assert_eq!(color("link.mtl"), None);
        let fifo = at("robot/meshes/fifo.mtl");
        assert!(std::process::Command::new("mkfifo").arg(&fifo).status().unwrap().success());
        assert_eq!(color("fifo.mtl"), None);
    }
}

#[test]
fn obj_counts_from_both_ends() {
    let parts = read_as("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0 1\nf -3 -2 -1\nv 0 1 0\nf 1/1 2 3/3/3 -1\n").unwrap();
    assert_eq!((triangles(&parts), parts[0].surface.vertices.len()), (3, 4));
    for face in
        ["f 1 2 4", "f 0 1 2", "f -4 1 2", "f 1 2 99999999999999999999", "f 1 2 x", "f 1 2 -9223372036854775808"]
    {
        assert_eq!(
            refusal("a.obj", format!("v 0 0 0\nv 1 0 0\nv 1 1 0\n{face}\n")),
            "line 4: a face names a corner that is not there"
        );
    }
    assert_eq!(refusal("a.obj", "v 0 0 0\nf 1 1"), "it holds no triangle");
    assert_eq!(refusal("a.obj", "v 0 0 0\nf 1"), "line 2: a face has three corners");
    assert_eq!(refusal("a.obj", "v 0 0"), "line 1: a corner has three numbers");
}

#[test]
fn what_is_no_mesh_is_refused_with_its_reason() {
    let mut short = cube_stl_bytes();
    short.truncate(300);
    short[0] = b'x';
    assert_eq!(refusal("a.stl", short), "it ends before the number of triangles that it tells");
    assert_eq!(refusal("a.stl", ""), "it ends before the number of triangles that it tells");
    assert_eq!(refusal("a.stl", "solid\nfacet\nvertex 1 2\n"), "line 3: a corner has three numbers");
    assert_eq!(refusal("a.stl", "solid\nfacet\nvertex 1 2 3\nendfacet\n"), "line 4: a facet has three corners");
    assert_eq!(refusal("a.glb", "glTF"), "its name does not end with .stl, .obj or .dae");
    let far = "a coordinate is beyond 1e9 or not finite";
    for number in ["3e38", "1e39", "NaN", "inf", "-1e10"] {
        assert_eq!(refusal("a.obj", cube_obj().replacen("v 1 1 0", &format!("v 1 {number} 0"), 1)), far);
        assert_eq!(refusal("a.dae", cubes(&[&format!("<scale>1 1 {number}</scale>")])), far);
    }
    let stride = cubes(&[""]).replace("stride=\"3\"", "stride=\"0\"");
    assert_eq!(refusal("a.dae", stride), "the stride of positions is not 3, or somewhat more");
    let count = cubes(&[""]).replace("count=\"8\"", "count=\"4294967295\"");
    assert_eq!(refusal("a.dae", count), "an accessor tells of more points than are there");
    let entities = "<!DOCTYPE x [<!ENTITY a SYSTEM \"file:///etc/passwd\">]><COLLADA>&a;</COLLADA>";
    assert!(refusal("a.dae", entities).starts_with("it is no XML that can be read: "));
}

#[test]
fn depth_instances_and_shared_numbers_are_bounded() {
    let begun = Instant::now();
    let deep = |depth: usize| {
        let (open, close) = ("<node><rotate>0 0 1 90</rotate>".repeat(depth), "</node>".repeat(depth));
        cubes(&[""]).replace(
            "<visual_scene id=\"s\">",
            &format!("<visual_scene id=\"s\">{open}<instance_geometry url=\"#g0\"/>{close}"),
        )
    };
    assert_eq!(triangles(&read_as("a.dae", deep(100_000)).unwrap()), 24);
    assert_eq!(refusal("a.dae", deep(200_000)), "it has too many tags");
    // 2⁴⁰ instances of a cube, and a node within itself.
    let doubled: String = (0..40)
        .map(|k| {
            format!("<node id=\"d{k}\"><instance_node url=\"#d{0}\"/><instance_node url=\"#d{0}\"/></node>", k + 1)
        })
        .collect();
    for nodes in [
        format!("{doubled}<node id=\"d40\"><instance_geometry url=\"#g0\"/></node>"),
        "<node id=\"d\"><instance_node url=\"#d\"/></node>".into(),
    ] {
        let text = cubes(&[""]).replace("<visual_scene id=\"s\">", &format!("<visual_scene id=\"s\">{nodes}"));
        let reason = refusal("a.dae", text);
        assert!(reason.contains("too many") || reason.contains("more than"), "{reason}");
    }
    let attributes: String = (0..1000).map(|k| format!(" a{k}=\"\"")).collect();
    assert_eq!(refusal("a.dae", format!("<COLLADA{attributes}/>")), "a tag has too many attributes");
    let names: String = (0..100).map(|k| format!("<a xmlns:b{k}=\"c\">")).collect();
    assert_eq!(refusal("a.dae", format!("<?x \" ?>{names}")), "it has too many namespaces");
    // Many meshes of the same numbers.
    let numbers = "0 0 0 1 0 0 1 1 0 ".repeat(20_000);
    let meshes = "<geometry><mesh><vertices><input semantic=\"POSITION\" source=\"#p\"/></vertices></mesh></geometry>"
        .repeat(1000);
    let text = format!(
        "<COLLADA><library_geometries><source id=\"p\"><float_array>{numbers}</float_array></source>{meshes}</library_geometries></COLLADA>"
    );
    assert_eq!(refusal("a.dae", text), "its meshes share their numbers too often");
    println!("{:.1} s", begun.elapsed().as_secs_f64());
}

#[test]
fn files_outside_and_what_is_no_file_are_not_opened() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    fs::create_dir_all(at("robot/dir.stl")).unwrap();
    fs::write(at("out.stl"), cube_stl_bytes()).unwrap();
    let reason = |path: PathBuf| read(&MeshFile { path, folder: at("robot") }).expect_err("it is read").to_string();
    let outside = "it is outside the folder of the robot and its packages";
    assert_eq!(reason(at("out.stl")), outside);
    assert_eq!(reason(at("robot/../out.stl")), outside);
    assert_eq!(reason(at("robot/none.stl")), "it is not there");
    assert_eq!(reason(at("robot/dir.stl")), "it is no ordinary file");
    let large = File::create(at("robot/large.stl")).unwrap();
    large.set_len(LARGEST + 1).unwrap();
    assert_eq!(reason(at("robot/large.stl")), "it is larger than 64 MiB");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(at("out.stl"), at("robot/link.stl")).unwrap();
        assert_eq!(reason(at("robot/link.stl")), outside);
        assert!(std::process::Command::new("mkfifo").arg(at("robot/fifo.stl")).status().unwrap().success());
        assert_eq!(reason(at("robot/fifo.stl")), "it is no ordinary file");
    }
}
