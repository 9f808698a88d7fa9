# Installs Pyrophone for the present user, or with --system for all users (in a window opened as administrator).
# Nothing is downloaded. The program itself does it, as it does for install.cmd.
& (Join-Path $PSScriptRoot "pyrophone.exe") install @args
exit $LASTEXITCODE
