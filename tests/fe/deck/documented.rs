//! The keywords in `docs/decks.md` are those that the reader knows.

use fallwerk::fe::deck::{DeckOptions, parse};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

fn known(keyword: &str) -> bool {
    let text = format!("*KEYWORD\n*{keyword}\n");
    match parse(&text, "one.k", DeckOptions::default()) {
        Ok(_) => true,
        Err(errors) => !errors.to_string().contains("unknown-keyword"),
    }
}

/// What `_MORE` beside `*NAME` may stand for: an option, another last word or two, or the number of a material.
fn spellings(name: &str, more: &str) -> Vec<String> {
    let mut all = vec![format!("{name}{more}"), format!("MAT{more}")];
    let mut rest = name;
    while let Some((shorter, _)) = rest.rsplit_once('_') {
        all.push(format!("{shorter}{more}"));
        rest = shorter;
    }
    all
}

/// The keywords of lists and of the first column of tables.
fn documented() -> BTreeSet<String> {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/decks.md")).unwrap();
    let body = text.split("## Keywords").nth(1).unwrap().split("## Conventions").next().unwrap();
    let mut found = BTreeSet::new();
    let mut name = String::new();
    for line in body.lines() {
        let cell = if line.starts_with('|') { line.split('|').nth(1).unwrap() } else { line };
        for word in cell.split('`').skip(1).step_by(2) {
            if let Some(keyword) = word.strip_prefix('*') {
                assert!(known(keyword), "docs/decks.md has *{keyword}, which the reader does not know");
                name = keyword.to_string();
                found.insert(name.clone());
            } else if word.starts_with('_') {
                let meant: Vec<String> = spellings(&name, word).into_iter().filter(|k| known(k)).collect();
                assert!(
                    !meant.is_empty(),
                    "docs/decks.md has {word} after *{name}, which the reader does not know"
                );
                found.extend(meant);
            }
        }
    }
    found
}

#[test]
fn the_list_of_keywords_is_that_of_the_reader() {
    let mut listed = documented();
    // these stand under Format
    listed.extend(
        ["INCLUDE", "INCLUDE_PATH", "INCLUDE_PATH_RELATIVE", "PARAMETER", "PARAMETER_LOCAL"]
            .map(String::from),
    );
    listed.extend(["KEYWORD_ID", "KEYWORD_JOBID"].map(String::from));
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/fe/deck");
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        let words = text.split('"').filter(|w| {
            w.len() > 3 && w.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_')
        });
        for keyword in words.filter(|w| known(w)) {
            assert!(listed.contains(keyword), "docs/decks.md lacks *{keyword} ({})", path.display());
            count += 1;
        }
    }
    assert!(count > 100, "{count} keywords in the source");
}
