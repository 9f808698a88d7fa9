#!/bin/sh
# Installs Pyrophone for the present user. Nothing is downloaded.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
plugins=$HOME/Library/Audio/Plug-Ins
presets=$HOME/Library/Audio/Presets/Pyrophone/Pyrophone

mkdir -p "$plugins/CLAP" "$plugins/VST3" "$presets" "$HOME/.local/bin"
rm -rf "$plugins/CLAP/Pyrophone.clap" "$plugins/VST3/Pyrophone.vst3" "$presets/Factory"
cp -R "$here/Pyrophone.clap" "$plugins/CLAP/"
cp -R "$here/Pyrophone.vst3" "$plugins/VST3/"
cp -R "$here/presets/Pyrophone/Pyrophone/Factory" "$presets/"
cp "$here/pyrophone" "$HOME/.local/bin/"
echo "Done. Have your host look for new plug-ins (rescan)."
echo "To hear fire without a host: ~/.local/bin/pyrophone render --preset campfire --seconds 10 --output campfire.wav"
