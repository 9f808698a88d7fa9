# Installs Pyrophone for the present user, or with -System for all users (in a window opened as administrator).
# Nothing is downloaded.
param([switch]$System)
$ErrorActionPreference = "Stop"

if ($System) {
    $clap = Join-Path $env:CommonProgramFiles "CLAP"
    $vst3 = Join-Path $env:CommonProgramFiles "VST3"
    $programs = Join-Path $env:ProgramFiles "Pyrophone"
} else {
    $clap = Join-Path $env:LOCALAPPDATA "Programs\Common\CLAP"
    $vst3 = Join-Path $env:LOCALAPPDATA "Programs\Common\VST3"
    $programs = Join-Path $env:LOCALAPPDATA "Programs\Pyrophone"
}
$presets = Join-Path ([Environment]::GetFolderPath("MyDocuments")) "VST3 Presets\Pyrophone\Pyrophone"

function Put($name, $folder) {
    $installed = Join-Path $folder (Split-Path $name -Leaf)
    New-Item -ItemType Directory -Force -Path $folder | Out-Null
    if (Test-Path -LiteralPath $installed) { Remove-Item -LiteralPath $installed -Recurse -Force }
    Copy-Item -LiteralPath (Join-Path $PSScriptRoot $name) -Destination $folder -Recurse
    Write-Output $installed
}

Put "Pyrophone.clap" $clap
Put "Pyrophone.vst3" $vst3
Put "pyrophone.exe" $programs
# Of the presets only the factory's are replaced: what hosts have saved beside them is the user's.
Put "presets\Pyrophone\Pyrophone\Factory" $presets
Write-Output "Done. Have your host look for new plug-ins (rescan)."
Write-Output "To hear fire without a host: & '$programs\pyrophone.exe' render --preset campfire --seconds 10 --output campfire.wav"
