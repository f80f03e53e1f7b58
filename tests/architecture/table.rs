//! The allowed direction of use, in one place.

/// A module of `src/` and the modules it may name.
pub struct Module {
    /// Name, as in `crate::NAME`.
    pub name: &'static str,
    /// Modules it may use.
    pub uses: &'static [&'static str],
}

/// All modules in the order of the data flow: each may use only modules that stand above it, and of those only the ones
/// listed. `fe` and `mbs` know nothing of rules, library or each other; rules, library and graph meet in `generate`;
/// `report` shows plain data; nothing uses `cli`.
pub const MODULES: &[Module] = &[
    Module { name: "base", uses: &[] },
    Module { name: "building", uses: &["base"] },
    Module { name: "material", uses: &["base", "building"] },
    Module { name: "curve", uses: &["base"] },
    Module { name: "graph", uses: &["base", "building", "material", "curve"] },
    Module { name: "fe", uses: &["base", "building", "material"] },
    Module { name: "mbs", uses: &["base", "curve"] },
    Module { name: "rc", uses: &["base", "building", "material", "curve", "fe"] },
    Module { name: "library", uses: &["base", "building", "material", "curve", "fe", "rc"] },
    Module { name: "study", uses: &["base", "building", "fe"] },
    Module { name: "rules", uses: &["base", "building", "study"] },
    Module {
        name: "generate",
        uses: &[
            "base", "building", "material", "curve", "graph", "fe", "mbs", "rc", "library", "study", "rules",
        ],
    },
    Module { name: "validate", uses: &["base", "building", "curve", "fe", "mbs", "study"] },
    Module { name: "review", uses: &["base", "building", "mbs", "generate", "validate"] },
    Module { name: "learn", uses: &["base", "building", "graph", "study", "rules", "generate", "validate"] },
    Module { name: "verify", uses: &["base", "building", "material", "curve", "fe", "mbs", "rc"] },
    Module {
        name: "bench",
        uses: &[
            "base", "building", "material", "curve", "graph", "fe", "mbs", "rc", "library", "study", "rules",
            "generate", "validate", "verify",
        ],
    },
    Module { name: "export", uses: &["base", "curve", "mbs"] },
    Module { name: "report", uses: &["base"] },
    Module {
        name: "cli",
        uses: &[
            "base", "building", "material", "curve", "graph", "fe", "mbs", "rc", "library", "study", "rules",
            "generate", "validate", "review", "learn", "verify", "bench", "export", "report",
        ],
    },
];

/// A crate that only some files may name.
pub struct Confined {
    /// Name of the crate in Rust paths.
    pub krate: &'static str,
    /// Files, or folders with a slash at the end, from `src/`.
    pub within: &'static [&'static str],
}

/// Crates behind a wall: exchanging one of them touches the files named here.
pub const CONFINED: &[Confined] = &[
    Confined { krate: "sled", within: &["library/cache.rs"] },
    Confined { krate: "parry3d_f64", within: &["mbs/contact/collide.rs"] },
    Confined { krate: "faer", within: &["fe/preload.rs", "base/sparse.rs"] },
    Confined { krate: "postcard", within: &["fe/restart.rs"] },
    Confined { krate: "serde_path_to_error", within: &["base/json.rs"] },
    Confined { krate: "clap", within: &["cli/"] },
];

/// Most lines of a file in `src/`.
pub const MOST_LINES: usize = 700;

/// The module with this name.
pub fn module(name: &str) -> Option<&'static Module> {
    MODULES.iter().find(|m| m.name == name)
}
