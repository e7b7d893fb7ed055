use super::*;

/// splitmix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() % count.max(1) as u64) as usize
    }
}

/// What strangers write in the place of something.
const WORDS: [&str; 24] = [
    "0",
    "-1",
    "3",
    "4294967295",
    "4000000000",
    "18446744073709551615",
    "1e38",
    "-3.4e38",
    "1e400",
    "NaN",
    "inf",
    "",
    "#",
    "#p0",
    "#g0",
    "#n0",
    "<node>",
    "</node>",
    "<p>",
    "/",
    "\"",
    "\u{fffd}",
    "mtllib /dev/zero\n",
    "<instance_node url=\"#n0\"/>",
];

/// Some bytes changed: words in the place of numbers, bytes flipped, stretches left out, doubled or moved.
fn damaged(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len());
        let length = random.below(40).min(bytes.len() - at);
        match random.below(6) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => drop(bytes.drain(at..at + length)),
            2 => {
                let stretch = bytes[at..at + length].to_vec();
                let to = random.below(bytes.len());
                drop(bytes.splice(to..to, stretch));
            }
            3 => bytes.truncate(at.max(1)),
            _ => {
                // The number, or the text in quotes, that stands there.
                let is_end = |byte: &u8| b" \"<>\n/".contains(byte);
                let start = bytes[..at].iter().rposition(is_end).map_or(0, |k| k + 1);
                let end = bytes[at..].iter().position(is_end).map_or(bytes.len(), |k| at + k);
                drop(bytes.splice(start..end.max(start), WORDS[random.below(WORDS.len())].bytes()));
            }
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

/// Reads so many damaged files of each format; each either reads or is refused, in no time to speak of.
fn campaign(count: usize, seed: u64) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cube.mtl"), "newmtl blue\nKd 0 0 1\n").unwrap();
    let dae = cubes(&["", "<rotate>0 0 1 90</rotate>", "<matrix>1 0 0 20 0 2 0 0 0 0 1 0 0 0 0 1</matrix>"]);
    let sound: [(&str, Vec<u8>); 4] = [
        ("a.dae", dae.into()),
        ("a.obj", cube_obj().into()),
        ("a.stl", cube_stl_text().into()),
        ("b.stl", cube_stl_bytes()),
    ];
    let (mut random, mut read_too, mut refused) = (Random(seed), 0, 0);
    for k in 0..count {
        // COLLADA has the most to go wrong.
        let (name, bytes) = &sound[[0, 0, 0, 1, 2, 3][k % 6]];
        let (path, bytes) = (folder.path().join(name), damaged(bytes, &mut random));
        fs::write(&path, &bytes).unwrap();
        let begun = Instant::now();
        match read(&MeshFile { path, folder: folder.path().to_owned() }) {
            Ok(parts) => {
                read_too += 1;
                for part in &parts {
                    let count = part.surface.vertices.len() as u32;
                    assert!(part.surface.triangles.iter().flatten().all(|corner| *corner < count), "{k}");
                    assert!(part.surface.vertices.iter().flatten().all(|number| number.abs() <= FARTHEST), "{k}");
                }
            }
            Err(_) => refused += 1,
        }
        let took = begun.elapsed();
        assert!(took.as_secs() < 60, "{k} of seed {seed}: {took:?}: {}", String::from_utf8_lossy(&bytes));
    }
    println!("{count} damaged files: {read_too} read, {refused} refused");
    assert!(read_too > count / 20 && refused > count / 20, "{read_too} {refused}");
}

#[test]
fn damaged_files_are_read_or_refused() {
    campaign(1_500, 1);
}

#[test]
#[ignore = "some minutes"]
fn a_hundred_thousand_damaged_files_are_read_or_refused() {
    campaign(100_000, 2);
}
