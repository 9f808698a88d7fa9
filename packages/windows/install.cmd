@echo off
rem Installs Pyrophone for the present user, or with --system for all users (opened as administrator).
rem Nothing is downloaded.
"%~dp0pyrophone.exe" install %*
set result=%errorlevel%
pause
exit /b %result%
