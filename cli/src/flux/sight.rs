//! Facts from the first good frame of a simulation: size, placement and units.

use pyrophone_flame::import::{GridInfo, Selection, Sequence};

use crate::args::{FluxArgs, Measure, Placement};
use crate::error::Error;
use crate::progress::{Work, note};

/// Iso value of a field that ranges from 0 to 1.
const ISO: f64 = 0.5;

/// Facts from one frame.
pub struct Sight {
    /// Value of the field at the front.
    pub iso: f64,
    /// Voxel edges in world units.
    pub voxel_edges: [f64; 3],
    /// Lowest and highest corners of the burning region in world units; none before ignition.
    pub extent: Option<[[f64; 3]; 2]>,
    /// Name of the burning field.
    pub field: String,
    /// Name of the velocity grid, or names of its components; empty if the velocity is not needed.
    pub velocity: String,
    /// True if Blender wrote the file.
    pub is_blender: bool,
}

impl Sight {
    /// Examines a frame.
    ///
    /// Fails if the frame cannot be read, or if the value at its front is unknown.
    pub fn of_sequence(
        sequence: &Sequence,
        index: usize,
        selection: &Selection,
        args: &FluxArgs,
    ) -> Result<Self, Error> {
        let description = sequence.describe(index)?;
        let (info, velocity) = match args.measure {
            Measure::Flux => {
                let selected = description.select(selection)?;
                let velocity = selected.velocity.map(|index| &description.grids[index]);
                note_staggered(velocity[0], args);
                let names = velocity.map(|grid| grid.name.as_str());
                let name = if selected.is_split() { names.join(" ") } else { names[0].to_owned() };
                (&description.grids[selected.field], name)
            }
            _ => (&description.grids[description.select_field(selection)?], String::new()),
        };
        if info.is_unit_dependent() && args.iso.is_none() && args.measure == Measure::Flux {
            return Err(Error::Conflict(format!(
                "the grid {} has a physical unit, so its value at the flame front is unknown; give it with --iso, or choose another --field",
                info.name
            )));
        }
        let field = sequence.read_field(index, selection)?;
        let transform = field.transform();
        let corners =
            field.bounds().map(|(low, high)| [low, high].map(|index| transform.to_world(index.map(f64::from))));
        Ok(Self {
            iso: args.iso.unwrap_or(if info.is_level_set() { 0.0 } else { ISO }),
            voxel_edges: transform.voxel_edges(),
            extent: corners,
            field: info.name.clone(),
            is_blender: info.is_blender,
            velocity,
        })
    }

    /// Examines the first frame in which anything burns; none if nothing burns in any.
    ///
    /// Fails if that frame cannot be read, unless bad frames are to be skipped and a later one can.
    pub fn of_first(
        sequence: &Sequence,
        indices: &[usize],
        selection: &Selection,
        args: &FluxArgs,
        work: &Work,
    ) -> Result<Option<Self>, Error> {
        let look = |index: &usize| {
            work.check()?;
            Self::of_sequence(sequence, *index, selection, args)
        };
        // If all are bad, the first one's reason is reported: most often a name that no frame has. A frame before
        // ignition has no field, and so nothing to report.
        let mut lit = indices.iter().skip_while(|index| sequence.is_unlit(**index, selection));
        let Some(first) = lit.next() else { return Ok(None) };
        let is_bad = |found: &Result<Self, Error>| matches!(found, Err(Error::Import(_)));
        let found = look(first);
        if !is_bad(&found) || !args.skip_bad {
            return found.map(Some);
        }
        match lit.map(look).find(|found| !is_bad(found)) {
            Some(later) => later.map(Some),
            // A farm's shard without one good frame writes an empty part.
            None if args.partial.file.is_some() => Ok(None),
            None => found.map(Some),
        }
    }

    /// Examines the first good frame in which anything burns, if there is one.
    pub fn of_any(sequence: &Sequence, indices: &[usize], selection: &Selection, args: &FluxArgs) -> Option<Self> {
        let mut lit = indices.iter().skip_while(|index| sequence.is_unlit(**index, selection));
        lit.find_map(|index| Self::of_sequence(sequence, *index, selection, args).ok())
    }

    /// Voxel edges, as text.
    pub fn voxel_text(&self) -> String {
        self.voxel_edges.map(shortly).join(" x ")
    }

    /// Extent of the burning region, as text.
    pub fn extent_text(&self) -> String {
        self.extent.map_or("nothing burns".into(), |[low, high]| {
            let edges: [String; 3] =
                std::array::from_fn(|axis| shortly((high[axis] - low[axis]).abs() + self.voxel_edges[axis]));
            edges.join(" x ")
        })
    }
}

fn note_staggered(velocity: &GridInfo, args: &FluxArgs) {
    if velocity.is_staggered() && args.velocity.placement == Placement::Collocated {
        note(&format!(
            "the grid {} is staggered (components on the voxels' faces), but is read at the voxels' centres; --placement file reads it as stored",
            velocity.name
        ));
    }
}

/// The number to six significant digits, without trailing zeros.
fn shortly(number: f64) -> String {
    format!("{number:.5e}").parse::<f64>().unwrap_or(number).to_string()
}
