//! Cases: what they are, which are run, and running them side by side.

use super::figure::Figure;
use rayon::prelude::*;

/// What runs a case; the error says why it came to no figures.
pub type Run = Box<dyn Fn() -> Result<Vec<Figure>, String> + Send + Sync>;

/// A verification case.
pub struct Case {
    /// Name on the command line.
    pub name: String,
    /// What is modelled and what is checked, one sentence.
    pub about: &'static str,
    /// Whether it belongs to the short form, whose cases together take less than 30 s of one processor.
    pub short: bool,
    /// Computes its figures.
    pub run: Run,
}

impl Case {
    /// A case of the short form.
    pub fn short(
        name: impl Into<String>,
        about: &'static str,
        run: impl Fn() -> Result<Vec<Figure>, String> + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.into(), about, short: true, run: Box::new(run) }
    }

    /// A case of the full form only.
    pub fn long(
        name: impl Into<String>,
        about: &'static str,
        run: impl Fn() -> Result<Vec<Figure>, String> + Send + Sync + 'static,
    ) -> Self {
        Self { short: false, ..Self::short(name, about, run) }
    }

    /// Its figures, with its name in them.
    pub fn figures(&self) -> Result<Vec<Figure>, Failed> {
        let failed = |message: String| Failed { case: self.name.clone(), message };
        let mut figures = (self.run)().map_err(failed)?;
        figures.iter_mut().for_each(|f| f.case.clone_from(&self.name));
        Ok(figures)
    }
}

/// A case that came to no figures.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("case {case}: {message}")]
pub struct Failed {
    /// Its name.
    pub case: String,
    /// Why.
    pub message: String,
}

/// The cases of the short form or all, those whose name is or begins with `name` if one is given.
///
/// # Errors
/// If no case has that name.
pub fn select(cases: Vec<Case>, short: bool, name: Option<&str>) -> Result<Vec<Case>, String> {
    let Some(name) = name else {
        return Ok(cases.into_iter().filter(|c| c.short || !short).collect());
    };
    let names: Vec<String> = cases.iter().map(|c| c.name.clone()).collect();
    let chosen: Vec<Case> = cases.into_iter().filter(|c| c.name.starts_with(name)).collect();
    if chosen.is_empty() {
        return Err(format!("no case begins with `{name}`; there are: {}", names.join(", ")));
    }
    Ok(chosen)
}

/// Runs cases side by side in the current rayon pool; results in the order of the cases. `done` is called after each with its name.
pub fn run(cases: &[Case], done: &(dyn Fn(&str) + Sync)) -> Vec<Result<Vec<Figure>, Failed>> {
    let one = |case: &Case| {
        let figures = case.figures();
        done(&case.name);
        figures
    };
    cases.par_iter().with_max_len(1).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cases() -> Vec<Case> {
        let figure = || Ok(vec![Figure::relative("x", "-", [1.0, 1.0], 0.0, "s")]);
        vec![
            Case::short("a", "", figure),
            Case::long("a-fine", "", figure),
            Case::short("b", "", || Err("no state".into())),
        ]
    }

    #[test]
    fn cases_are_chosen_by_form_and_by_name() {
        let names = |short, name| {
            select(cases(), short, name).map(|c| c.into_iter().map(|c| c.name).collect::<Vec<_>>())
        };
        assert_eq!(names(true, None).unwrap(), ["a", "b"]);
        assert_eq!(names(false, None).unwrap(), ["a", "a-fine", "b"]);
        assert_eq!(names(true, Some("a-")).unwrap(), ["a-fine"]);
        assert!(names(false, Some("c")).unwrap_err().contains("a-fine"));
    }

    #[test]
    fn results_keep_the_order_and_name_what_failed() {
        let results = run(&cases(), &|_| ());
        assert_eq!(results[1].as_ref().unwrap()[0].case, "a-fine");
        assert_eq!(results[2].as_ref().unwrap_err().to_string(), "case b: no state");
    }
}
