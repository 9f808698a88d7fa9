# Removes what install.ps1 has put in place; with -System for all users. Your own presets and recordings stay.
param([switch]$System)
$ErrorActionPreference = "Stop"

if ($System) {
    $common = $env:CommonProgramFiles
    $programs = Join-Path $env:ProgramFiles "Pyrophone"
} else {
    $common = Join-Path $env:LOCALAPPDATA "Programs\Common"
    $programs = Join-Path $env:LOCALAPPDATA "Programs\Pyrophone"
}
$presets = Join-Path ([Environment]::GetFolderPath("MyDocuments")) "VST3 Presets\Pyrophone\Pyrophone\Factory"

foreach ($installed in @((Join-Path $common "CLAP\Pyrophone.clap"), (Join-Path $common "VST3\Pyrophone.vst3"), $programs, $presets)) {
    if (Test-Path -LiteralPath $installed) { Remove-Item -LiteralPath $installed -Recurse -Force }
}
Write-Output "Pyrophone is removed."
