use super::*;
use proptest::prelude::*;

const OBJ: &str = "# a strip\nmtllib x.mtl\no plate\nv 0 0 0\nv 1 0 0 # corner\nv 1 1 0 1 0 0\n\
    v 0 1 0\nvt 0 0\nvn 0 0 1\ng one\nf 1/1/1 2/1/1 \\\n  3/1/1 4/1/1\nv 2 0 0\nv 2 1 0\n\
    s off\nf -2 -1 3\nf 2//1 5//1 3//1\nl 1 2\n";

fn square_stl() -> String {
    let facet = |v: [&str; 3]| {
        let corners = v.map(|p| format!("      vertex {p}\n")).concat();
        format!("  facet normal 0 0 1\n    outer loop\n{corners}    endloop\n  endfacet\n")
    };
    let body = facet(["0 0 0", "1 0 0", "1 1 0"]) + &facet(["0 0 -0", "1 1 0", "0 1 0"]);
    format!("solid a square\n{body}endsolid a square\n")
}

fn binary_stl(facets: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = b"solid it says, but it is binary".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(u32::try_from(facets.len()).unwrap().to_le_bytes());
    for facet in facets {
        bytes.extend([0; 12]);
        bytes.extend(facet.iter().flatten().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

const PLY: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\n\
    property uchar red\nproperty double z\nproperty float x\nproperty float y\n\
    element edge 1\nproperty int a\nproperty list uchar int b\n\
    element face 2\nproperty list uchar uint vertex_index\nproperty float quality\nend_header\n\
    255 0 0 0\n255 0 1 0\n255 0 1 1\n255 0.5 0 1\n3 2 7 8\n4 0 1 2 3 0.5\n3 0 1 2 0.25\n";

/// The same as [`PLY`] in binary, with other types.
fn binary_ply(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 4\nproperty double z\n\
         property short x\nproperty float y\nelement face 2\nproperty uchar flags\n\
         property list ushort int vertex_indices\nend_header\n"
    )
    .into_bytes();
    let mut put = |mut little: Vec<u8>| {
        if big {
            little.reverse();
        }
        bytes.append(&mut little);
    };
    for (x, y, z) in [
        (0i16, 0f32, 0f64),
        (1, 0.0, 0.0),
        (1, 1.0, 0.0),
        (0, 1.0, 0.5),
    ] {
        put(z.to_le_bytes().to_vec());
        put(x.to_le_bytes().to_vec());
        put(y.to_le_bytes().to_vec());
    }
    for face in [&[0i32, 1, 2, 3][..], &[0, 1, 2]] {
        put(vec![7]);
        put(u16::try_from(face.len()).unwrap().to_le_bytes().to_vec());
        face.iter().for_each(|i| put(i.to_le_bytes().to_vec()));
    }
    bytes
}

fn fault(bytes: &[u8]) -> (Place, Fault) {
    let error = read(bytes).unwrap_err();
    assert!(error.sentence().ends_with('.') && !error.hint().is_empty());
    (error.place, error.fault)
}

fn obj_fault(text: &str) -> (Place, Fault) {
    fault(text.as_bytes())
}

#[test]
fn obj_with_all_its_ways_of_writing_a_face() {
    let reading = read(OBJ.as_bytes()).unwrap();
    let faces = [
        Face::Quad([0, 1, 2, 3]),
        Face::Triangle([4, 5, 2]),
        Face::Triangle([1, 4, 2]),
    ];
    assert_eq!(reading.mesh.faces(), faces);
    assert_eq!(reading.mesh.vertices()[2], Point3::new(1.0, 1.0, 0.0));
    assert_eq!(
        reading.sentence(),
        "read as OBJ: 6 vertices, 2 triangles, 1 quads"
    );
    let dos = OBJ.replace('\n', "\r\n");
    assert_eq!(read(dos.as_bytes()).unwrap(), reading);
    let mut latin1 = b"# Gr\xf6\xdfe\n".to_vec();
    latin1.extend_from_slice(OBJ.as_bytes());
    assert_eq!(read(&latin1).unwrap(), reading);
    let forward = "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0";
    assert_eq!(read(forward.as_bytes()).unwrap().mesh.faces().len(), 1);
}

#[test]
fn stl_corners_become_vertices_in_the_order_in_which_they_come() {
    let text = read(square_stl().as_bytes()).unwrap();
    assert_eq!(text.how.format, MeshFormat::AsciiStl);
    assert_eq!(text.mesh.vertices().len(), 4);
    assert_eq!(
        text.mesh.faces(),
        [Face::Triangle([0, 1, 2]), Face::Triangle([0, 2, 3])]
    );
    let facets = [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
        [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    ];
    let binary = read(&binary_stl(&facets)).unwrap();
    assert_eq!(binary.how.format, MeshFormat::BinaryStl);
    assert_eq!(binary.mesh, text.mesh);
    assert_eq!(binary.how.collapsed, 1);
    assert!(binary.sentence().contains("1 faces with two corners"));
}

#[test]
fn ply_in_all_encodings() {
    let text = read(PLY.as_bytes()).unwrap();
    assert_eq!(text.mesh.vertices()[3], Point3::new(0.0, 1.0, 0.5));
    assert_eq!(
        text.mesh.faces(),
        [Face::Quad([0, 1, 2, 3]), Face::Triangle([0, 1, 2])]
    );
    for big in [false, true] {
        assert_eq!(read(&binary_ply(big)).unwrap(), text);
    }
}

#[test]
fn faults_of_obj_name_their_line() {
    let three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let cases = [
        (
            format!("{three}f 1 2 4\n"),
            4,
            Fault::NoSuchVertex { vertices: 3 },
        ),
        (
            format!("{three}f 1 2 -4\n"),
            4,
            Fault::NoSuchVertex { vertices: 3 },
        ),
        (format!("{three}f 0 1 2\n"), 4, Fault::NotAnIndex),
        (format!("{three}f 1 2.5 3\n"), 4, Fault::NotAnIndex),
        (format!("{three}f 1 2\n"), 4, Fault::Corners),
        (format!("{three}f 1 2 3 1 2\n"), 4, Fault::Corners),
        ("v 0 0\nf 1 1 1\n".into(), 1, Fault::TooFewCoordinates),
        ("v 0 0,5 0\n".into(), 1, Fault::NotANumber),
        ("v 0 inf 0\n".into(), 1, Fault::NotANumber),
    ];
    for (text, line, expected) in cases {
        assert_eq!(obj_fault(&text), (Place::Line(line), expected), "{text}");
    }
    assert_eq!(obj_fault(three), (Place::File, Fault::NoFaces));
    let sentence = read(format!("{three}f 1 2 4\n").as_bytes()).unwrap_err();
    assert_eq!(
        sentence.sentence(),
        "Line 4: there are 3 vertices, but not this one: “4”."
    );
    assert_eq!(sentence.pointer(), "file, line 4");
}

#[test]
fn faults_of_stl_and_ply_name_their_place() {
    let cut = square_stl()
        .replace("endsolid a square\n", "")
        .replacen("endfacet", "", 2);
    assert_eq!(obj_fault(&cut).1, Fault::UnexpectedWord);
    let short = square_stl().replace("      vertex 1 1 0\n", "");
    assert_eq!(obj_fault(&short), (Place::Line(7), Fault::FacetCorners));
    let open = "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0";
    assert_eq!(obj_fault(open), (Place::Line(4), Fault::EndsEarly));

    let facet = [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]];
    let mut stl = binary_stl(&facet);
    stl[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(fault(&stl), (Place::Byte(80), Fault::Promises));

    let many = PLY.replace("vertex 4", "vertex 5");
    assert_eq!(obj_fault(&many), (Place::Line(21), Fault::LeftOver));
    let range = PLY.replace("3 0 1 2 0.25", "3 0 1 9 0.25");
    assert_eq!(
        obj_fault(&range),
        (Place::Line(22), Fault::NoSuchVertex { vertices: 4 })
    );
    let short = PLY.replace("3 0 1 2 0.25", "3 0 1 2");
    assert_eq!(obj_fault(&short), (Place::Line(22), Fault::EndsEarly));
    let long = PLY.replace("3 0 1 2 0.25", "3 0 1 2 0.25 9");
    assert_eq!(obj_fault(&long), (Place::Line(22), Fault::LeftOver));
    let no_z = PLY.replace("double z", "double w");
    assert!(matches!(
        obj_fault(&no_z),
        (Place::Line(4), Fault::Header(_))
    ));
    let strange = PLY.replace("double z", "quad z");
    assert!(matches!(
        obj_fault(&strange),
        (Place::Line(6), Fault::Header(_))
    ));

    let mut binary = binary_ply(false);
    let text = String::from_utf8_lossy(&binary).into_owned();
    assert!(text.contains("element face 2"));
    let at = binary.windows(6).position(|w| w == b"face 2").unwrap();
    binary.splice(at..at + 6, *b"face 4000000000");
    assert_eq!(fault(&binary), (Place::Line(7), Fault::Promises));
}

#[test]
fn what_is_no_mesh_is_said_to_be_none() {
    for bytes in [
        &b""[..],
        b"hello",
        b"\x00\x01\x02",
        b"ISO-10303-21;\nHEADER;\n",
        b"1,2,3\n",
    ] {
        assert_eq!(fault(bytes), (Place::File, Fault::UnknownFormat));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Files cut short or with changed bytes give a mesh or an error, and
    /// nothing is ever set aside for what they do not hold.
    #[test]
    fn broken_files_never_panic(
        which in 0usize..5,
        cut in 0.0..1.2f64,
        flips in prop::collection::vec((0.0..1.0f64, any::<u8>()), 0..6),
    ) {
        let facets = [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]; 3];
        let mut bytes = match which {
            0 => OBJ.as_bytes().to_vec(),
            1 => square_stl().into_bytes(),
            2 => binary_stl(&facets),
            3 => PLY.as_bytes().to_vec(),
            _ => binary_ply(cut > 0.5),
        };
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let place = |share: f64, len: usize| (share * len as f64) as usize;
        bytes.truncate(place(cut, bytes.len()));
        for (at, byte) in flips {
            let at = place(at, bytes.len());
            if let Some(slot) = bytes.get_mut(at) {
                *slot = byte;
            }
        }
        match read(&bytes) {
            Ok(reading) => prop_assert!(reading.mesh.vertices().len() <= bytes.len()),
            Err(error) => prop_assert!(!error.sentence().is_empty()),
        }
    }
}
