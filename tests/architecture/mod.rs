//! Holds the source to its design: direction of use between modules, tables that name every module, length of files, elementary
//! functions of one library, no paths of some machine.

mod check;
mod elementary;
mod pages;
mod table;
mod tokens;

use std::path::{Path, PathBuf};
use table::{MODULES, MOST_LINES};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Files below a folder, sorted; folders for which `enters` says no are left out.
fn files(folder: &Path, enters: &dyn Fn(&Path) -> bool) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        .map(|e| e.unwrap().path())
        .collect();
    entries.sort();
    let mut found = Vec::new();
    for path in entries {
        if path.is_symlink() {
            continue;
        }
        if !path.is_dir() {
            found.push(path);
        } else if enters(&path) {
            found.extend(files(&path, enters));
        }
    }
    found
}

/// Path below the root of the package, with `/`.
fn shown(path: &Path, below: &Path) -> String {
    let relative = path.strip_prefix(below).unwrap();
    relative.components().map(|c| c.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
}

fn text(name: &str) -> String {
    std::fs::read_to_string(root().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Rust files of `src/` with their paths below it.
fn sources() -> Vec<(String, String)> {
    let src = root().join("src");
    let all = files(&src, &|_| true);
    let rust = all.iter().filter(|p| p.extension().is_some_and(|e| e == "rs"));
    let list: Vec<_> = rust.map(|p| (shown(p, &src), std::fs::read_to_string(p).unwrap())).collect();
    assert!(list.len() > 50, "only {} files found below {}", list.len(), src.display());
    list
}

fn none(breaches: &[String]) {
    assert!(breaches.is_empty(), "\n{}", breaches.join("\n"));
}

#[test]
fn the_table_is_in_its_own_order() {
    for (index, module) in MODULES.iter().enumerate() {
        for used in module.uses {
            let above = MODULES[..index].iter().any(|m| m.name == *used);
            assert!(above, "`{}` uses `{used}`, which does not stand above it", module.name);
        }
    }
}

#[test]
fn modules_use_only_what_they_may() {
    let mut breaches = Vec::new();
    for (path, source) in sources() {
        breaches.extend(
            check::breaches(&path, &source)
                .into_iter()
                .map(|b| format!("src/{path}:{}: {}", b.line, b.message)),
        );
    }
    none(&breaches);
}

#[test]
fn no_source_file_is_long() {
    let long = |(path, source): (String, String)| {
        let lines = source.lines().count();
        (lines > MOST_LINES).then(|| format!("src/{path}: {lines} lines, at most {MOST_LINES}"))
    };
    none(&sources().into_iter().filter_map(long).collect::<Vec<_>>());
}

#[test]
fn nobody_holds_a_standard_stream() {
    // progress is told from the threads of a pool: one that waits for the stream waits for ever
    let held = |text: &str| ["stderr().lock()", "stdout().lock()"].iter().any(|lock| text.contains(lock));
    none(&sources().into_iter().filter(|(_, text)| held(text)).map(|(path, _)| path).collect::<Vec<_>>());
}

/// Rows `| [`name`] | ... |` or `| `name` | ... |` of a table: cells without back quotes and brackets.
fn rows(text: &str) -> Vec<Vec<String>> {
    text.lines()
        .map(|line| line.trim_start_matches("//!").trim())
        .filter(|line| line.starts_with("| `") || line.starts_with("| [`"))
        .map(|line| {
            line.trim_matches('|')
                .split('|')
                .map(|cell| cell.replace(['`', '[', ']'], "").trim().to_string())
                .collect()
        })
        .collect()
}

#[test]
fn the_table_of_lib_rs_names_every_module_in_order() {
    let source = text("src/lib.rs");
    let named: Vec<String> = rows(&source).into_iter().map(|r| r[0].clone()).collect();
    assert_eq!(named, MODULES.iter().map(|m| m.name).collect::<Vec<_>>());
    let mut declared: Vec<&str> = source
        .lines()
        .filter_map(|l| l.strip_prefix("pub mod ").or_else(|| l.strip_prefix("mod ")))
        .map(|l| l.trim_end_matches(';'))
        .collect();
    declared.sort_unstable();
    let mut listed: Vec<&str> = MODULES.iter().map(|m| m.name).collect();
    listed.sort_unstable();
    assert_eq!(declared, listed);
}

#[test]
fn the_table_of_architecture_md_is_the_table_of_this_test() {
    let page = text("ARCHITECTURE.md");
    let section = page
        .split("\n## ")
        .find(|s| s.starts_with("Modules"))
        .expect("ARCHITECTURE.md has a section `Modules`");
    let table = rows(section);
    assert_eq!(
        table.iter().map(|r| r[0].as_str()).collect::<Vec<_>>(),
        MODULES.iter().map(|m| m.name).collect::<Vec<_>>()
    );
    for (row, module) in table.iter().zip(MODULES) {
        let allowed = match module.uses {
            [] => "nothing".to_string(),
            uses if module.name == "cli" && uses.len() + 1 == MODULES.len() => "all above".to_string(),
            uses => uses.join(", "),
        };
        assert_eq!(row.last(), Some(&allowed), "ARCHITECTURE.md, row `{}`, last column", module.name);
    }
}

#[test]
fn readme_names_every_command() {
    let help = std::process::Command::new(env!("CARGO_BIN_EXE_fallwerk")).arg("--help").output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    let list = help.split("Commands:").nth(1).expect("the help lists the commands");
    let commands: Vec<&str> = list
        .lines()
        .skip(1)
        .take_while(|l| !l.trim().is_empty())
        .filter(|l| l.starts_with("  ") && !l.starts_with("   "))
        .filter_map(|l| l.split_whitespace().next())
        .filter(|c| *c != "help")
        .collect();
    assert!(commands.contains(&"simulate"), "no commands found in:\n{help}");
    let readme = text("README.md");
    let table = readme
        .split("\n## ")
        .find(|s| s.starts_with("Commands"))
        .expect("README.md has a section `Commands`");
    let named = rows(table);
    let missing: Vec<_> =
        commands.iter().filter(|c| !named.iter().any(|r| r[0].split([' ', ',']).next() == Some(c))).collect();
    assert!(missing.is_empty(), "README.md does not name {missing:?}");
}

/// Folders named in `.gitignore` at the root, and hidden ones but that of the CI script.
fn is_repository_folder(path: &Path, ignored: &[PathBuf]) -> bool {
    let name = path.file_name().unwrap().to_string_lossy();
    !ignored.iter().any(|i| i == path) && (!name.starts_with('.') || name == ".ci")
}

/// Lines that name a place on somebody's machine.
fn machine_paths(text: &str) -> Vec<usize> {
    let places = ["work", "root", "home", "Users"].map(|p| format!("/{p}/"));
    // `https://example.org/home/` and `a/work/b` are no paths of a machine: nothing but a separator may stand before one
    let begins = |line: &str, at: usize| {
        line[..at].chars().next_back().is_none_or(|c| !c.is_alphanumeric() && !"./_-~".contains(c))
    };
    let hit =
        |line: &str| places.iter().any(|p| line.match_indices(p.as_str()).any(|(at, _)| begins(line, at)));
    text.lines().enumerate().filter(|(_, line)| hit(line)).map(|(i, _)| i + 1).collect()
}

#[test]
fn no_text_file_names_a_place_on_a_machine() {
    let ignored: Vec<PathBuf> = text(".gitignore")
        .lines()
        .filter_map(|l| l.trim().strip_prefix('/').map(|l| root().join(l)))
        .collect();
    let all = files(root(), &|folder| is_repository_folder(folder, &ignored));
    let mut breaches = Vec::new();
    for path in all.iter().filter(|p| p.file_name().is_some_and(|n| n != ".git")) {
        let Ok(content) = std::fs::read_to_string(path) else { continue }; // not text
        breaches.extend(
            machine_paths(&content)
                .iter()
                .map(|l| format!("{}:{l}: a path of some machine", shown(path, root()))),
        );
    }
    none(&breaches);
}

#[test]
fn machine_paths_are_told_from_others() {
    let line = |before: &str, place: &str| format!("fine\nsee {before}/{place}/x for more\n");
    assert_eq!(machine_paths(&line("", "work")), [2]);
    assert_eq!(machine_paths(&line("`", "home")), [2]);
    assert_eq!(machine_paths(&line("https://example.org", "home")), [0; 0]);
    assert_eq!(machine_paths(&line("group", "work")), [0; 0]);
}
