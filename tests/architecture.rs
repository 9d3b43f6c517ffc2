//! The invariants of the house, read from the source: which layer may see
//! which, who touches the disk, the clock, the settings and status codes, and
//! how long a file may get.
//!
//! The reader is a lexer, not a compiler: it drops comments and literals, then
//! looks for paths. A path smuggled in by a macro would escape it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What each layer may use besides itself. The programme's own part (`main`,
/// `app`, `settings`, `telemetry`, `cli`) may use everything.
const ARROWS: [(&str, &[&str]); 8] = [
    ("numerics", &[]),
    ("geometry", &["numerics"]),
    ("solver", &["numerics"]),
    ("methods", &["solver", "geometry", "numerics"]),
    ("workshop", &["geometry", "numerics"]),
    ("formats", &["geometry", "numerics"]),
    ("jobs", &["methods"]),
    (
        "http",
        &["jobs", "formats", "workshop", "methods", "geometry"],
    ),
];
/// Layers above all arrows.
const PROGRAMME: [&str; 6] = ["main", "lib", "app", "settings", "telemetry", "cli"];
/// Crates of the wire, the runtime and the machine.
const WORLDLY: [&str; 15] = [
    "serde",
    "serde_json",
    "tokio",
    "axum",
    "hyper",
    "hyper_util",
    "tower",
    "tower_http",
    "utoipa",
    "rusqlite",
    "clap",
    "tracing",
    "metrics",
    "uuid",
    "jiff",
];
/// Layers that must stay pure mathematics.
const PURE: [&str; 6] = [
    "numerics", "geometry", "solver", "methods", "workshop", "formats",
];
/// A file longer than this wants to be two.
const MOST_LINES: usize = 600;
/// Status codes of success, which a handler may name.
const SUCCESS: [&str; 6] = [
    "OK",
    "CREATED",
    "ACCEPTED",
    "NO_CONTENT",
    "PARTIAL_CONTENT",
    "NOT_MODIFIED",
];

/// One source file, comments and literals taken out.
struct Source {
    /// Path below `src`, with `/`.
    path: String,
    code: String,
    lines: usize,
}

impl Source {
    fn new(path: &str, text: &str) -> Source {
        Source {
            path: path.to_owned(),
            code: code_only(text),
            lines: text.lines().count(),
        }
    }

    /// The folder or file right below `src`, without `.rs`.
    fn layer(&self) -> &str {
        self.path
            .split('/')
            .next()
            .unwrap_or("")
            .trim_end_matches(".rs")
    }

    /// How many modules deep the file stands: `jobs/mod.rs` 1, `jobs/a.rs` 2.
    fn depth(&self) -> usize {
        let parts = self.path.split('/').count();
        if self.path.ends_with("/mod.rs") {
            parts - 1
        } else {
            parts
        }
    }

    /// The code without its unit tests, which stand at the end of a file.
    fn shipped(&self) -> &str {
        let tests = self
            .path
            .split(['/', '.'])
            .any(|part| part == "tests" || part.ends_with("_tests"));
        let end = self
            .code
            .find("#[cfg(test)]\nmod ")
            .unwrap_or(self.code.len());
        if tests { "" } else { &self.code[..end] }
    }

    /// Top-level modules of this crate that the code names.
    fn uses(&self) -> Vec<String> {
        let words = tokens(&self.code);
        let mut found = Vec::new();
        for (at, word) in words.iter().enumerate() {
            let root = match word.as_str() {
                "crate" | "mouldloft" => words
                    .get(at + 1)
                    .is_some_and(|w| w == "::")
                    .then_some(at + 2),
                "super" if at == 0 || words[at - 1] != "::" => self.climbs_out(&words, at),
                _ => None,
            };
            if let Some(start) = root {
                found.extend(first_names(&words, start));
            }
        }
        found.retain(|name| is_layer(name));
        found.sort();
        found.dedup();
        found
    }

    /// Where a chain of `super::` that reaches the crate's root goes on.
    fn climbs_out(&self, words: &[String], at: usize) -> Option<usize> {
        let chain = words[at..]
            .chunks(2)
            .take_while(|c| c[0] == "super" && c.len() == 2 && c[1] == "::");
        let supers = chain.count();
        (supers >= self.depth()).then_some(at + 2 * supers)
    }

    /// Whether the shipped code names this path, whole words only.
    fn names(&self, path: &str) -> bool {
        let wanted = tokens(path);
        tokens(self.shipped())
            .windows(wanted.len())
            .any(|w| w == wanted)
    }
}

fn is_layer(name: &str) -> bool {
    ARROWS.iter().any(|(layer, _)| *layer == name) || PROGRAMME.contains(&name)
}

/// The first segment of every path that begins at `start`: one name, or the
/// heads of a braced list.
fn first_names(words: &[String], start: usize) -> Vec<String> {
    if words.get(start).is_none_or(|w| w != "{") {
        return words.get(start).cloned().into_iter().collect();
    }
    let mut names = Vec::new();
    let mut depth = 0;
    for (at, word) in words.iter().enumerate().skip(start) {
        match word.as_str() {
            "{" => depth += 1,
            "}" if depth == 1 => break,
            "}" => depth -= 1,
            _ if depth == 1 && matches!(words[at - 1].as_str(), "{" | ",") => {
                names.push(word.clone())
            }
            _ => {}
        }
    }
    names
}

/// Words, `::`, and every other sign by itself.
fn tokens(code: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut glue = false;
    for c in code.chars() {
        let of_word = c.is_alphanumeric() || c == '_';
        let pair = c == ':' && words.last().is_some_and(|w| w == ":") && glue;
        match words.last_mut() {
            Some(word)
                if glue && of_word && word.ends_with(|l: char| l.is_alphanumeric() || l == '_') =>
            {
                word.push(c);
            }
            Some(word) if pair => word.push(c),
            _ if c.is_whitespace() => {}
            _ => words.push(c.to_string()),
        }
        glue = !c.is_whitespace();
    }
    words
}

/// Drops comments and the insides of literals.
fn code_only(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut code = String::with_capacity(text.len());
    let mut at = 0;
    while at < chars.len() {
        let next = skip(&chars, at);
        if next == at {
            code.push(chars[at]);
            at += 1;
        } else {
            code.push(' ');
            at = next;
        }
    }
    code
}

/// The end of the comment or literal that begins at `at`, or `at` itself.
fn skip(chars: &[char], at: usize) -> usize {
    let rest = &chars[at..];
    let find = |from: usize, end: &[char]| {
        let hit = rest[from..].windows(end.len()).position(|w| w == end);
        hit.map_or(chars.len(), |i| at + from + i + end.len())
    };
    match rest {
        // The line's end stays, so that lines stay lines.
        ['/', '/', ..] => find(2, &['\n']).saturating_sub(1).max(at + 2),
        ['/', '*', ..] => find(2, &['*', '/']),
        ['r', '"', ..] => find(2, &['"']),
        ['r', '#', '"', ..] => find(3, &['"', '#']),
        ['"', ..] => string_end(chars, at),
        ['\'', '\\', ..] => find(3, &['\'']),
        ['\'', _, '\'', ..] => at + 3,
        _ => at,
    }
}

/// The end of an ordinary string literal.
fn string_end(chars: &[char], start: usize) -> usize {
    let mut at = start + 1;
    while at < chars.len() && chars[at] != '"' {
        at += if chars[at] == '\\' { 2 } else { 1 };
    }
    (at + 1).min(chars.len())
}

fn house() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let sources: Vec<Source> = files_below(&root)
        .iter()
        .map(|file| {
            let path = file
                .strip_prefix(&root)
                .expect("below src")
                .to_string_lossy()
                .replace('\\', "/");
            Source::new(
                &path,
                &std::fs::read_to_string(file).expect("a readable source"),
            )
        })
        .collect();
    assert!(sources.len() > 20, "the house was not found");
    sources
}

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable entry").path();
        if path.is_dir() {
            found.extend(files_below(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Every edge that no arrow allows.
fn upward_edges(sources: &[Source]) -> Vec<String> {
    let arrows: BTreeMap<&str, &[&str]> = ARROWS.into_iter().collect();
    let mut bad = Vec::new();
    for source in sources.iter().filter(|s| !PROGRAMME.contains(&s.layer())) {
        let Some(allowed) = arrows.get(source.layer()) else {
            bad.push(format!(
                "{}: the layer {:?} has no arrows",
                source.path,
                source.layer()
            ));
            continue;
        };
        let uses = source.uses();
        let wrong = uses
            .iter()
            .filter(|u| *u != source.layer() && !allowed.contains(&u.as_str()));
        bad.extend(wrong.map(|u| format!("{} uses {u}", source.path)));
    }
    bad
}

/// Files below `layers` that name one of `paths`, but for `exempt` beginnings.
fn offenders(sources: &[Source], paths: &[&str], exempt: &[&str]) -> Vec<String> {
    let guarded = sources
        .iter()
        .filter(|s| !exempt.iter().any(|e| s.path.starts_with(e)));
    guarded
        .flat_map(|s| {
            paths
                .iter()
                .filter(|p| s.names(p))
                .map(|p| format!("{}: {p}", s.path))
        })
        .collect()
}

fn assert_none(found: Vec<String>, rule: &str) {
    assert!(found.is_empty(), "{rule}\n{}", found.join("\n"));
}

#[test]
fn no_arrow_points_upwards() {
    assert_none(upward_edges(&house()), "these uses point upwards:");
}

#[test]
fn mathematics_knows_no_wire_and_no_runtime() {
    let pure: Vec<Source> = house()
        .into_iter()
        .filter(|s| PURE.contains(&s.layer()))
        .collect();
    let paths: Vec<String> = WORLDLY.iter().map(|c| format!("{c}::")).collect();
    let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
    assert_none(
        offenders(&pure, &paths, &[]),
        "these crates have no business there:",
    );
}

#[test]
fn only_the_store_and_the_command_line_touch_the_disk() {
    // The command line reads the job and writes the files that it is told to.
    let paths = ["std::fs", "tokio::fs", "fs::", "File::", "OpenOptions"];
    let found = offenders(&house(), &paths, &["jobs/store", "cli/"]);
    assert_none(found, "the disk belongs to jobs/store and cli:");
}

#[test]
fn only_one_module_reads_the_clock() {
    let paths = [
        "Instant",
        "SystemTime",
        "UNIX_EPOCH",
        "Timestamp::now",
        "Zoned::now",
    ];
    assert_none(
        offenders(&house(), &paths, &["jobs/clock.rs"]),
        "the clock belongs to jobs/clock:",
    );
}

#[test]
fn only_problems_pick_status_codes() {
    let house = house();
    let mut found = Vec::new();
    for source in house.iter().filter(|s| !s.path.starts_with("http/problem")) {
        let words = tokens(source.shipped());
        let codes = words
            .windows(3)
            .filter(|w| w[0] == "StatusCode" && w[1] == "::");
        let wrong = codes.filter(|w| !SUCCESS.contains(&w[2].as_str()));
        let shouted = wrong.filter(|w| w[2].chars().all(|c| c.is_ascii_uppercase() || c == '_'));
        found.extend(shouted.map(|w| format!("{}: {}", source.path, w[2])));
    }
    assert_none(found, "failures get their status in http/problem:");
}

#[test]
fn only_the_programme_reads_settings() {
    let house: Vec<Source> = house()
        .into_iter()
        .filter(|s| !PROGRAMME.contains(&s.layer()))
        .collect();
    let paths = ["crate::settings", "env::var", "env::args", "clap::"];
    assert_none(
        offenders(&house, &paths, &[]),
        "settings are handed down, not fetched:",
    );
}

#[test]
fn files_stay_short() {
    let long = house().into_iter().filter(|s| s.lines > MOST_LINES);
    assert_none(
        long.map(|s| format!("{}: {} lines", s.path, s.lines))
            .collect(),
        "split these:",
    );
}

mod the_rules_themselves {
    use super::*;

    fn edges(path: &str, text: &str) -> Vec<String> {
        upward_edges(&[Source::new(path, text)])
    }

    #[test]
    fn refuse_a_made_up_upward_edge() {
        assert_eq!(
            edges("geometry/a.rs", "use crate::http::Router;"),
            ["geometry/a.rs uses http"]
        );
        assert_eq!(
            edges("geometry/a.rs", "use crate::solver;"),
            ["geometry/a.rs uses solver"]
        );
        assert_eq!(
            edges("jobs/mod.rs", "use super::http::x;"),
            ["jobs/mod.rs uses http"]
        );
        assert_eq!(
            edges(
                "solver/a/b.rs",
                "fn f() { super::super::super::app::run() }"
            )
            .len(),
            1
        );
        let list = "use crate::{\n    numerics::{band, http_like},\n    jobs as j,\n};";
        assert_eq!(edges("methods/x.rs", list), ["methods/x.rs uses jobs"]);
        assert_eq!(
            edges("attic/x.rs", "").len(),
            1,
            "a new layer needs its arrows"
        );
    }

    #[test]
    fn allow_downward_edges_comments_and_literals() {
        assert!(edges("http/a.rs", "use crate::jobs::Queue; use crate::formats;").is_empty());
        assert!(
            edges(
                "geometry/a.rs",
                "//! see crate::http\nuse super::super::numerics;"
            )
            .is_empty()
        );
        let text = "const A: &str = \"\\\" crate::http\"; const Q: char = '\"'; /* crate::jobs */";
        assert!(edges("geometry/a.rs", text).is_empty());
        assert!(
            edges(
                "jobs/a.rs",
                "use super::model; mod t { use super::super::clock; }"
            )
            .is_empty()
        );
    }

    #[test]
    fn see_whole_paths_only() {
        let source = Source::new(
            "jobs/a.rs",
            "let now = Instant::now();\n#[cfg(test)]\nmod tests { File::open() }",
        );
        assert!(source.names("Instant"));
        assert!(!source.names("Inst"));
        assert!(!source.names("File::"), "unit tests may touch the disk");
    }
}
