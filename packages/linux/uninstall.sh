#!/bin/sh
# Removes what install.sh has put in place; with --system for all users. Your own presets and recordings stay.
set -eu

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
    echo "usage: uninstall.sh [--system]" >&2
    exit 2
    ;;
esac

# Of the presets only the factory's: what hosts have saved beside them is the user's.
rm -rf "$clap/Pyrophone.clap" "$vst3/Pyrophone.vst3" "$programs/pyrophone" "$presets/Pyrophone/Pyrophone/Factory"
rm -f "$manuals/pyrophone.1" "$manuals"/pyrophone-*.1
rmdir "$presets/Pyrophone/Pyrophone" "$presets/Pyrophone" 2>/dev/null || true
echo "Pyrophone is removed."
