#!/bin/sh
# Installs Pyrophone for the present user, or with --system for all users. Nothing is downloaded.
set -eu
here=$(cd "$(dirname "$0")" && pwd)

case "${1:-}" in
"")
    clap=$HOME/.clap vst3=$HOME/.vst3 programs=$HOME/.local/bin presets=$HOME/.vst3/presets
    manuals=${XDG_DATA_HOME:-$HOME/.local/share}/man/man1
    ;;
--system)
    clap=/usr/lib/clap vst3=/usr/lib/vst3 programs=/usr/local/bin presets=/usr/share/vst3/presets
    manuals=/usr/local/share/man/man1
    ;;
*)
    echo "usage: install.sh [--system]" >&2
    exit 2
    ;;
esac

# The old files are removed, not overwritten: a host that has them open keeps what it has loaded.
put() {
    mkdir -p "$2"
    rm -rf "$2/$(basename "$1")"
    cp -R "$1" "$2/"
    echo "$2/$(basename "$1")"
}

put "$here/Pyrophone.clap" "$clap"
put "$here/Pyrophone.vst3" "$vst3"
put "$here/pyrophone" "$programs"
# Of the presets only the factory's are replaced: what hosts have saved beside them is the user's.
put "$here/presets/Pyrophone/Pyrophone/Factory" "$presets/Pyrophone/Pyrophone"
for page in "$here"/man/*.1; do
    put "$page" "$manuals" >/dev/null
done

echo "Done. Have your host look for new plug-ins (rescan)."
echo "To hear fire without a host: $programs/pyrophone render --preset campfire --seconds 10 --output campfire.wav"
case ":$PATH:" in
*":$programs:"*) ;;
*) echo "For the command line, add $programs to PATH." ;;
esac
