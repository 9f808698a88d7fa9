# Removes what install.ps1 has put in place; with --system for all users. Your own presets and recordings stay.
& (Join-Path $PSScriptRoot "pyrophone.exe") uninstall @args
exit $LASTEXITCODE
