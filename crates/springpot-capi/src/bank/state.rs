//! The state of a bank as bytes.

use super::{Bank, Stage};
use crate::hash::Hash;
use crate::sealed;
use crate::status::{Problem, Status};
use serde::{Deserialize, Serialize};
use springpot::collocation::Nodes;
use springpot::elements::BankState;
use springpot::fractional::Form;

/// What the bytes begin with: what they are, and how they are laid out.
const MARK: &[u8] = b"springpot-bank-1";

/// What outlasts the steps of a bank.
#[derive(Serialize, Deserialize)]
struct Written {
    identity: u128,
    t: f64,
    energies: Vec<[f64; 3]>,
    state: BankState,
}

/// What tells banks apart: their elements and how steps are asked.
pub(super) fn identity(text: &str, nodes: Nodes, form: Form) -> u128 {
    Hash::new().with(text.as_bytes()).with(format!("{nodes:?} {form:?}").as_bytes()).value()
}

impl Bank {
    /// What it takes to go on from the last commit, to the bit, in this bank or in another one of the same text, nodes and form.
    ///
    /// # Errors
    /// [`Status::Order`] before [`Self::begin`].
    pub fn save(&self) -> Result<Vec<u8>, Problem> {
        self.check_begun()?;
        let (identity, energies) = (self.identity, self.energies.clone());
        let written = Written { identity, t: self.t, energies, state: self.bank.state() };
        sealed::seal(MARK, &written).map_err(|error| Problem::new(Status::Defect, error.to_string()))
    }

    /// Goes on from what was saved, later or earlier.
    ///
    /// # Errors
    /// [`Status::State`], and nothing changed, where the bytes are torn or of another bank; [`Status::Order`] before [`Self::begin`].
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), Problem> {
        self.check_begun()?;
        let refuse = |why: &str| Problem::new(Status::State, format!("the bytes are no state of this bank: {why}"));
        let Written { identity, t, energies, state } = sealed::open(MARK, bytes).map_err(refuse)?;
        if identity != self.identity || energies.len() != self.len() || !self.bank.set_state(state) {
            return Err(refuse("they are of other elements, nodes or form"));
        }
        (self.t, self.energies, self.stage) = (t, energies, Stage::Between);
        Ok(())
    }

    pub(super) fn check_begun(&self) -> Result<(), Problem> {
        match self.stage {
            Stage::New => Err(Problem::new(Status::Order, "the bank has not begun: springpot_bank_begin comes first")),
            _ => Ok(()),
        }
    }
}
