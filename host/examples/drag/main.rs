//! Opens a small window from which a file can be dragged to another program's, under Windows: `cargo run --example drag --
//! recording.wav 1300 100` places it 1300 pixels from the left and 100 from the top.

#[cfg(windows)]
mod source;

#[cfg(windows)]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let file = arguments.next().ok_or("which file?")?;
    let mut number = || arguments.next().and_then(|text| text.into_string().ok()?.parse::<i32>().ok());
    let place = (number().ok_or("how far from the left?")?, number().ok_or("how far from the top?")?);
    source::offer(&file, place)?;
    Ok(())
}

#[cfg(not(windows))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    Err("this program drags as Windows does; tests on Linux drag by themselves".into())
}
