@echo off
rem Removes what install.cmd has put in place; with --system for all users. Your own presets and recordings stay.
"%~dp0pyrophone.exe" uninstall %*
set result=%errorlevel%
pause
exit /b %result%
