//! Pages for people: that of the architecture stays short, and links lead somewhere.

use std::path::Path;

use super::{files, none, root, shown, text};

/// What has to be argued at length stands in `docs/decisions/`.
const MOST_WORDS: usize = 3500;

#[test]
fn the_page_of_the_architecture_is_short() {
    let words = text("ARCHITECTURE.md").split_whitespace().count();
    assert!(words <= MOST_WORDS, "ARCHITECTURE.md: {words} words, at most {MOST_WORDS}");
}

/// Targets of links `[text](target)`, without those of the web.
fn links(page: &str) -> Vec<&str> {
    let targets = page.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter(|t| !t.contains("://") && !t.starts_with("mailto:")).collect()
}

/// Anchor of a heading as code hosts make it: lower case, spaces as hyphens, no punctuation.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().to_lowercase().replace(' ', "-");
    kept.chars().filter(|c| c.is_alphanumeric() || *c == '-' || *c == '_').collect()
}

/// What is wrong with a link of a page, if anything.
fn fault(page: &Path, link: &str) -> Option<String> {
    let (file, section) = link.split_once('#').unwrap_or((link, ""));
    let target = if file.is_empty() { page.to_path_buf() } else { page.parent()?.join(file) };
    if !target.exists() {
        return Some(format!("{}: `{link}` leads nowhere", shown(page, root())));
    }
    let has_section = || {
        let content = std::fs::read_to_string(&target).unwrap();
        let headings = content.lines().filter(|l| l.starts_with('#'));
        headings.map(|l| anchor(l.trim_start_matches('#'))).any(|a| a == section)
    };
    (!section.is_empty() && !has_section())
        .then(|| format!("{}: `{link}`: no such heading", shown(page, root())))
}

#[test]
fn links_of_pages_lead_somewhere() {
    let folders = ["docs", "kb", "buildings", "library", "rules", "benches", "decks"];
    let below = folders.iter().flat_map(|f| files(&root().join(f), &|_| true));
    let own = ["README.md", "ARCHITECTURE.md", "CHANGELOG.md"].map(|f| root().join(f));
    let pages: Vec<_> =
        own.into_iter().chain(below).filter(|p| p.extension().is_some_and(|e| e == "md")).collect();
    let mut seen = 0;
    let mut faults = Vec::new();
    for page in &pages {
        let content = std::fs::read_to_string(page).unwrap();
        let all = links(&content);
        seen += all.len();
        faults.extend(all.into_iter().filter_map(|link| fault(page, link)));
    }
    assert!(seen > 50, "only {seen} links found");
    none(&faults);
}
