//! Finds the modules and confined crates that a source file names, and says which of them it may not.

use super::table::{CONFINED, module};
use super::tokens::{Token, tokens};

/// A name that stands where it may not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Breach {
    /// Line, from 1.
    pub line: usize,
    /// What is wrong.
    pub message: String,
}

/// Breaches of one file; `path` is relative to `src/`, with `/`.
pub fn breaches(path: &str, source: &str) -> Vec<Breach> {
    let tokens = tokens(source);
    let mut found = confined(path, &tokens);
    // lib.rs declares the modules, main.rs enters the command line
    if let Some(owner) = owner(path) {
        match module(owner) {
            None => found.push(Breach {
                line: 1,
                message: format!("module `{owner}` is missing in the table of modules"),
            }),
            Some(own) => found.extend(uses(path, &tokens).into_iter().filter_map(|(name, line)| {
                let known = module(&name).is_some();
                (name != own.name && !own.uses.contains(&name.as_str())).then(|| Breach {
                    line,
                    message: match known {
                        true => format!("`{}` may not use `{name}`", own.name),
                        false => format!("`{name}` is not a module; name the module itself"),
                    },
                })
            })),
        }
    }
    found.sort_by_key(|b| b.line);
    found
}

/// The module a file belongs to; `None` for `lib.rs` and `main.rs`.
fn owner(path: &str) -> Option<&str> {
    match path {
        "lib.rs" | "main.rs" => None,
        _ => path.split('/').next().map(|first| first.trim_end_matches(".rs")),
    }
}

/// Names right below the root of the crate that a file reaches, by `crate::` or by enough `super::`, with their lines.
pub fn uses(path: &str, tokens: &[Token]) -> Vec<(String, usize)> {
    let is = |i: usize, text: &str| tokens.get(i).is_some_and(|t| t.text == text);
    let separator = |i: usize| is(i, ":") && is(i + 1, ":");
    let mut found = Vec::new();
    let mut inline = Vec::new(); // brace depths of inline modules
    let mut depth = 0;
    let mut i = 0;
    while i < tokens.len() {
        match tokens[i].text.as_str() {
            "{" => depth += 1,
            "}" => {
                depth -= 1;
                inline.retain(|d| *d < depth + 1);
            }
            "mod" if is(i + 2, "{") => inline.push(depth + 1),
            "crate" if separator(i + 1) => names_at(tokens, i + 3, &mut found),
            "crate" if is(i + 1, "as") => found.push(("crate as".into(), tokens[i].line)),
            "super" => {
                let mut supers = 1;
                while separator(i + 1) && is(i + 3, "super") {
                    supers += 1;
                    i += 3;
                }
                if supers >= file_depth(path) + inline.len() && separator(i + 1) {
                    names_at(tokens, i + 3, &mut found);
                }
            }
            _ => {}
        }
        i += 1;
    }
    found
}

/// How many modules deep the items of a file lie below the root.
fn file_depth(path: &str) -> usize {
    path.trim_end_matches(".rs").trim_end_matches("/mod").split('/').count()
}

/// The first names of the path, or of each path in the group, that begins at `start`.
fn names_at(tokens: &[Token], start: usize, found: &mut Vec<(String, usize)>) {
    let Some(first) = tokens.get(start) else { return };
    if first.text != "{" {
        found.push((first.text.clone(), first.line));
        return;
    }
    let (mut depth, mut begins) = (0, true);
    for token in &tokens[start..] {
        match token.text.as_str() {
            "{" => depth += 1,
            "}" => depth -= 1,
            "," => begins |= depth == 1,
            _ if begins && depth == 1 => {
                found.push((token.text.clone(), token.line));
                begins = false;
            }
            _ => {}
        }
        if depth == 0 {
            return;
        }
    }
}

/// Crates named outside the files they are confined to.
fn confined(path: &str, tokens: &[Token]) -> Vec<Breach> {
    let named = |i: usize, krate: &str| {
        let text = |i: usize| tokens.get(i).map(|t| t.text.as_str());
        let path = text(i + 1) == Some(":") && text(i + 2) == Some(":");
        let own = i >= 2 && text(i - 1) == Some(":") && text(i - 2) == Some(":"); // `x::sled` is another thing
        text(i) == Some(krate) && ((path && !own) || (i >= 1 && matches!(text(i - 1), Some("use" | "crate"))))
    };
    CONFINED
        .iter()
        .filter(|c| !c.within.iter().any(|w| path == *w || (w.ends_with('/') && path.starts_with(w))))
        .flat_map(|c| {
            (0..tokens.len()).filter(|i| named(*i, c.krate)).map(|i| Breach {
                line: tokens[i].line,
                message: format!("the crate `{}` may be named in {} only", c.krate, c.within.join(", ")),
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: [usize; 0] = [];

    fn lines(path: &str, source: &str) -> Vec<usize> {
        breaches(path, source).iter().map(|b| b.line).collect()
    }

    #[test]
    fn a_use_against_the_direction_is_found_with_its_line() {
        let source = "//! crate::mbs in a comment is no use.\nuse crate::building::Building;\nuse crate::mbs::Model;\n";
        let found = breaches("fe/run.rs", source);
        assert_eq!(found, [Breach { line: 3, message: "`fe` may not use `mbs`".into() }]);
        assert_eq!(lines("validate/mod.rs", source), NONE);
    }

    #[test]
    fn groups_expressions_and_supers_are_seen_through() {
        assert_eq!(
            lines("fe/run.rs", "use crate::{\n  building::{Building, mbs},\n  rules::RuleBase,\n};"),
            [3]
        );
        assert_eq!(lines("mbs/run.rs", "fn f() {\n  crate::fe::run();\n}"), [2]);
        assert_eq!(lines("mbs/mod.rs", "use super::fe::mesh;"), [1]);
        assert_eq!(lines("mbs/run.rs", "use super::fe::mesh;\nuse super::super::fe::mesh;"), [2]);
        assert_eq!(
            lines("mbs/run.rs", "mod tests {\n  use super::*;\n  use super::super::x;\n}\nfn f() {}"),
            NONE
        );
        assert_eq!(lines("mbs/run.rs", "mod tests {}\nuse super::super::fe;"), [2]);
        assert_eq!(lines("report/page.rs", "use crate::base::geom;\nuse crate::building::Building;"), [2]);
        assert_eq!(lines("generate/mod.rs", "use crate::cli::print;"), [1]);
    }

    #[test]
    fn the_root_of_the_crate_is_no_detour() {
        assert_eq!(lines("fe/run.rs", "use crate::*;\nuse crate::Building;\nuse crate as c;"), [1, 2, 3]);
        assert_eq!(lines("unheard_of/mod.rs", ""), [1]);
        assert_eq!(lines("lib.rs", "pub mod fe;"), NONE);
    }

    #[test]
    fn confined_crates_stay_in_their_files() {
        assert_eq!(lines("library/store.rs", "fn f(db: &sled::Db) {}"), [1]);
        assert_eq!(lines("library/cache.rs", "fn f(db: &sled::Db) {}"), NONE);
        assert_eq!(lines("library/store.rs", "let sled = \"sled::Db\"; // sled::Db"), NONE);
        assert_eq!(lines("mbs/contact.rs", "use parry3d_f64 as p;"), [1]);
        assert_eq!(lines("base/sparse.rs", "use faer::Mat;"), NONE);
        assert_eq!(lines("fe/run.rs", "use faer::Mat;"), [1]);
    }
}
