//! Instruction sets: a kernel is compiled once for each, and a run takes the widest that the processor has, or a given one.
//!
//! The results are the same bytes with each of them: vector code does for eight elements what scalar code does for one, operation by operation,
//! and nothing is fused or reordered. So the choice is no part of a model, and a run that goes on from a checkpoint makes its own; it decides only
//! how long a run takes.

use serde::{Deserialize, Serialize};

/// An instruction set of the kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Isa {
    /// What every processor of the target has: on x86-64 SSE2, two numbers at a time.
    Portable,
    /// AVX2, four numbers at a time.
    Avx2,
    /// AVX-512 with its parts F, VL and DQ, eight numbers at a time.
    Avx512,
}

impl Isa {
    /// All of them, the fastest first.
    pub const ALL: [Self; 3] = [Self::Avx512, Self::Avx2, Self::Portable];

    /// Name on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Whether this processor, under its operating system, has it.
    #[inline]
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512vl")
                    && is_x86_feature_detected!("avx512dq")
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// Those that this processor has, the fastest first.
    pub fn available() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|isa| isa.is_available())
    }

    /// The fastest that this processor has.
    pub fn best() -> Self {
        Self::available().next().unwrap_or(Self::Portable)
    }

    /// The instruction set with this name.
    ///
    /// # Errors
    /// If there is none, or this processor lacks it.
    pub fn named(name: &str) -> Result<Self, String> {
        let names = |all: &mut dyn Iterator<Item = Self>| all.map(Self::name).collect::<Vec<_>>().join(", ");
        let Some(isa) = Self::ALL.into_iter().find(|isa| isa.name() == name) else {
            return Err(format!(
                "no instruction set `{name}`; there are: {}",
                names(&mut Self::ALL.into_iter())
            ));
        };
        isa.or_lacking(isa.is_available(), &names(&mut Self::available()))
    }

    /// Itself if it is there, or what is there instead.
    fn or_lacking(self, is_available: bool, there: &str) -> Result<Self, String> {
        if is_available {
            return Ok(self);
        }
        Err(format!("this processor has no instruction set `{}`; it has: {there}", self.name()))
    }
}

/// Compiles a function once for each [`Isa`]: `fn chosen = all(arguments)` makes a function `chosen`, which takes an instruction set and
/// the arguments of `all`, and runs `all` in its code. `all`, and what it calls, must be inlined (`#[inline(always)]`): a function that is called
/// stays what the compiler makes for every processor. An instruction set that the processor lacks is replaced by the portable one.
macro_rules! for_each_isa {
    ($(#[$meta:meta])* $vis:vis fn $chosen:ident = $all:ident($($arg:ident: $type:ty),* $(,)?) $(-> $out:ty)?) => {
        $(#[$meta])*
        #[allow(clippy::too_many_arguments)]
        $vis fn $chosen(isa: $crate::base::isa::Isa, $($arg: $type),*) $(-> $out)? {
            #[cfg(target_arch = "x86_64")]
            #[allow(clippy::too_many_arguments)]
            #[target_feature(enable = "avx2")]
            fn avx2($($arg: $type),*) $(-> $out)? {
                $all($($arg),*)
            }

            #[cfg(target_arch = "x86_64")]
            #[allow(clippy::too_many_arguments)]
            #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
            fn avx512($($arg: $type),*) $(-> $out)? {
                $all($($arg),*)
            }

            #[cfg(target_arch = "x86_64")]
            #[expect(unsafe_code, reason = "calls code in instructions that not every processor has")]
            match isa {
                // SAFETY: the processor has them, as the guards of the arms have asked it.
                $crate::base::isa::Isa::Avx512 if isa.is_available() => return unsafe { avx512($($arg),*) },
                $crate::base::isa::Isa::Avx2 if isa.is_available() => return unsafe { avx2($($arg),*) },
                _ => {}
            }
            #[cfg(not(target_arch = "x86_64"))]
            let _ = isa;
            $all($($arg),*)
        }
    };
}
pub(crate) use for_each_isa;

#[cfg(test)]
mod tests {
    use super::Isa;

    #[test]
    fn names_lead_back_to_their_instruction_sets() {
        for isa in Isa::available() {
            assert_eq!(Isa::named(isa.name()), Ok(isa));
        }
        assert_eq!(Isa::available().last(), Some(Isa::Portable));
        assert!(Isa::best().is_available());
        let unknown = Isa::named("mmx").unwrap_err();
        assert!(Isa::ALL.iter().all(|isa| unknown.contains(isa.name())), "{unknown}");
    }

    #[test]
    fn a_lacking_one_is_named_with_those_that_are_there() {
        let lacking = Isa::Avx512.or_lacking(false, "avx2, portable").unwrap_err();
        assert_eq!(lacking, "this processor has no instruction set `avx512`; it has: avx2, portable");
        for isa in Isa::ALL.into_iter().filter(|isa| !isa.is_available()) {
            assert!(Isa::named(isa.name()).unwrap_err().contains("portable"));
        }
    }
}
