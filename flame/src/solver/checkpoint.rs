//! Checkpoints, from which an interrupted run resumes as if it had not been interrupted.

use std::io::{Read, Write};

use super::Solver;
use crate::error::Error;

/// First bytes of a saved run; the number changes with the format.
const MAGIC: &[u8; 8] = b"PYROSIM2";

impl Solver {
    /// Writes everything that the next step depends on: some 40 bytes per cell.
    ///
    /// # Errors
    /// If writing to `to` fails.
    pub fn save(&self, mut to: impl Write) -> std::io::Result<()> {
        to.write_all(MAGIC)?;
        for number in self.fingerprint() {
            to.write_all(&number.to_le_bytes())?;
        }
        to.write_all(&self.time_s.to_le_bytes())?;
        for values in self.state() {
            for value in values {
                to.write_all(&value.to_le_bytes())?;
            }
        }
        Ok(())
    }

    /// Restores a run saved by a solver with the same box and seed.
    ///
    /// # Errors
    /// If the bytes end early or belong to another run; the gas is then at rest.
    pub fn load(&mut self, mut from: impl Read) -> Result<(), Error> {
        let result = self.try_load(&mut from);
        if result.is_err() {
            self.reset();
        }
        result
    }

    fn try_load(&mut self, from: &mut impl Read) -> Result<(), Error> {
        let broken = |_| Error::Checkpoint { reason: "it ends early" };
        let mut magic = [0; 8];
        from.read_exact(&mut magic).map_err(broken)?;
        if &magic != MAGIC {
            return Err(Error::Checkpoint { reason: "it is of a different kind or version" });
        }
        let mut word = [0; 8];
        for expected in self.fingerprint() {
            from.read_exact(&mut word).map_err(broken)?;
            if u64::from_le_bytes(word) != expected {
                return Err(Error::Checkpoint { reason: "it was made with a different box, gas or seed" });
            }
        }
        from.read_exact(&mut word).map_err(broken)?;
        self.time_s = f64::from_le_bytes(word);
        if !self.time_s.is_finite() {
            return Err(Error::Checkpoint { reason: "it contains a number that is not finite" });
        }
        for values in self.state_mut() {
            let mut bytes = vec![0; 4 * values.len()];
            from.read_exact(&mut bytes).map_err(broken)?;
            for (value, bytes) in values.iter_mut().zip(bytes.as_chunks::<4>().0) {
                *value = f32::from_le_bytes(*bytes);
            }
        }
        if !self.is_finite() {
            return Err(Error::Checkpoint { reason: "it contains a number that is not finite" });
        }
        Ok(())
    }

    /// Settings that must be equal for a saved state to be valid.
    fn fingerprint(&self) -> Vec<u64> {
        let text = format!("{:?}{:?}", self.domain, self.parameters);
        // FNV-1a.
        let digest = text
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
        vec![self.seed, self.domain.cells() as u64, digest]
    }

    fn state(&self) -> Vec<&[f32]> {
        let [u, v, w] = &self.velocity.components;
        vec![u, v, w, self.scalars.as_flattened(), &self.pressure, &self.source, &self.front]
    }

    fn state_mut(&mut self) -> Vec<&mut [f32]> {
        let [u, v, w] = &mut self.velocity.components;
        vec![u, v, w, self.scalars.as_flattened_mut(), &mut self.pressure, &mut self.source, &mut self.front]
    }
}
