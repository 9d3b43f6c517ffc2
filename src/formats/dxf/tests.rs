use super::*;
use std::collections::BTreeSet;

fn drawing() -> Drawing {
    let corner = |x: f64, y: f64, bulge: f64| Corner {
        at: Point2::new(x, y),
        bulge,
    };
    Drawing {
        units: LengthUnit::Foot,
        entities: vec![
            Entity::Polyline {
                layer: Layer::Cut,
                // A half disc of radius 1: an arc below, a line above.
                corners: vec![corner(-1.0, 0.0, 1.0), corner(1.0, 0.0, 0.0)],
                closed: true,
            },
            Entity::Line {
                layer: Layer::Roll,
                ends: [Point2::new(0.0, -1.0), Point2::new(0.0, 0.0)],
            },
            Entity::Text {
                layer: Layer::Text,
                at: Point2::new(0.1, -0.5),
                height: 0.1,
                angle_deg: 90.0,
                text: "deck – chine".into(),
            },
        ],
    }
}

fn pairs(text: &str) -> Vec<(u16, &str)> {
    let lines: Vec<&str> = text.split("\r\n").collect();
    assert_eq!(lines.len() % 2, 1, "the file ends with a line end");
    (lines.chunks_exact(2))
        .map(|p| (p[0].trim().parse().unwrap(), p[1].trim()))
        .collect()
}

#[test]
fn sections_open_and_close_and_the_file_ends() {
    for (version, sections) in [
        (Version::R12, vec!["HEADER", "TABLES", "ENTITIES"]),
        (
            Version::R2000,
            vec![
                "HEADER", "CLASSES", "TABLES", "BLOCKS", "ENTITIES", "OBJECTS",
            ],
        ),
    ] {
        let text = write(&drawing(), version);
        let all = pairs(&text);
        let names: Vec<&str> = (all.windows(2))
            .filter(|w| w[0] == (0, "SECTION"))
            .map(|w| w[1].1)
            .collect();
        assert_eq!(names, sections);
        let ends = all.iter().filter(|p| **p == (0, "ENDSEC")).count();
        assert_eq!(ends, sections.len());
        assert_eq!(all.last(), Some(&(0, "EOF")));
    }
}

#[test]
fn handles_are_used_once_and_lie_below_the_seed() {
    let text = write(&drawing(), Version::R2000);
    let all = pairs(&text);
    let seed = all.windows(2).find(|w| w[0] == (9, "$HANDSEED")).unwrap()[1].1;
    let seed = u32::from_str_radix(seed, 16).unwrap();
    let mut seen = BTreeSet::new();
    for (_, handle) in all
        .iter()
        .filter(|(code, v)| *code == 105 || (*code == 5 && !v.is_empty()))
    {
        let number = u32::from_str_radix(handle, 16).unwrap();
        if number != seed {
            assert!(number < seed && seen.insert(number), "{handle}");
        }
    }
    for (_, owner) in all.iter().filter(|(code, v)| *code == 330 && *v != "0") {
        let number = u32::from_str_radix(owner, 16).unwrap();
        assert!(seen.contains(&number), "{owner}");
    }
}

#[test]
fn units_and_layers_are_said() {
    let text = write(&drawing(), Version::R2000);
    let all = pairs(&text);
    let units = all.windows(2).find(|w| w[0] == (9, "$INSUNITS")).unwrap();
    assert_eq!(units[1], (70, "2"));
    for layer in Layer::ALL {
        assert!(all.contains(&(2, layer.name())));
    }
    assert!(all.contains(&(1, "deck \\U+2013 chine")));
    assert!(all.contains(&(42, "1.0")));
}
