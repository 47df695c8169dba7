//! The signals that a host measures, those of the image among those of the ECU.

use hil_protocol::{Measured, Refusal, SignalIds};

use crate::punctuality::{FIRST_SIGNAL, LAST_SIGNAL, Punctuality};

/// The list, in the order in which a host asked for them.
#[derive(Clone, Debug)]
pub(crate) struct Measurement {
    ids: SignalIds,
}

impl Measurement {
    /// Nothing is measured.
    pub(crate) const fn new() -> Self {
        Self {
            ids: SignalIds::new(),
        }
    }

    /// This list, if the image has each of its signals that are its own.
    pub(crate) fn of(ids: &SignalIds, punctuality: &Punctuality) -> Result<Self, Refusal> {
        let unknown = |id: u16| id >= FIRST_SIGNAL && punctuality.signal(id).is_none();
        match ids.iter().find(|&&id| unknown(id)) {
            Some(&id) => Err(Refusal::UnknownSignal {
                id,
                last: LAST_SIGNAL,
            }),
            None => Ok(Self { ids: ids.clone() }),
        }
    }

    /// Whether nothing is measured.
    pub(crate) fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// What the ECU has to measure of it.
    pub(crate) fn of_the_ecu(&self) -> SignalIds {
        let mut ids = SignalIds::new();
        for &id in self.ids.iter().filter(|&&id| id < FIRST_SIGNAL) {
            // No longer than the list it is taken from.
            let _ = ids.push(id);
        }
        ids
    }

    /// All numbers in their order, given those of the ECU in theirs.
    pub(crate) fn merged(&self, of_the_ecu: &Measured, punctuality: &Punctuality) -> Measured {
        let mut of_the_ecu = of_the_ecu.iter();
        let mut all = Measured::new();
        for &id in &self.ids {
            let value = punctuality
                .signal(id)
                .or_else(|| of_the_ecu.next().copied());
            if let Some(value) = value {
                // As many as there are numbers of signals.
                let _ = all.push(value);
            }
        }
        all
    }
}
