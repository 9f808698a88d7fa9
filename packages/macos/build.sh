#!/bin/sh
# Makes the macOS package on a Mac: universal bundles and command line, signed and notarised where keys are named.
#
#   SIGN_IDENTITY    "Developer ID Application: ..." in the keychain; without it the bundles are signed ad hoc, which runs
#                    on the Mac that made them
#   NOTARY_PROFILE   what `xcrun notarytool store-credentials` has stored; without it nothing is sent to Apple
set -eu
cd "$(dirname "$0")/../.."

version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
# An empty one, as an unset secret is, counts as none.
identity=${SIGN_IDENTITY:--}
name=pyrophone-$version-macos-universal
stage=target/stage/$name
export MACOSX_DEPLOYMENT_TARGET=11.0

for target in aarch64-apple-darwin x86_64-apple-darwin; do
    rustup target add "$target"
    cargo build --release --target "$target" --package pyrophone-plugin --package pyrophone-cli
done

# Both processors' code in one file.
unite() {
    lipo -create "target/aarch64-apple-darwin/release/$1" "target/x86_64-apple-darwin/release/$1" -output "$2"
}

rm -rf "$stage"
for format in clap vst3; do
    contents=$stage/Pyrophone.$format/Contents
    mkdir -p "$contents/MacOS" "$contents/Resources"
    unite libpyrophone.dylib "$contents/MacOS/Pyrophone"
    sed -e "s/VERSION/$version/" -e "s/FORMAT/$format/" packages/macos/Info.plist >"$contents/Info.plist"
    printf 'BNDL????' >"$contents/PkgInfo"
done
sed "s/VERSION/$version/" xtask/moduleinfo.json >"$stage/Pyrophone.vst3/Contents/Resources/moduleinfo.json"
unite pyrophone "$stage/pyrophone"
cargo run --quiet --release --package pyrophone-settings --example vst3_presets -- "$stage/presets/Pyrophone/Pyrophone/Factory"
cargo xtask package --macos-licences "$stage"
cp -R README.md docs CHANGELOG.md CONTRIBUTING.md SECURITY.md LICENSE-APACHE LICENSE-MIT packages/macos/install.sh \
    "$stage/"

for item in "$stage/Pyrophone.clap" "$stage/Pyrophone.vst3" "$stage/pyrophone"; do
    if [ "$identity" = - ]; then
        codesign --force --sign - "$item"
    else
        codesign --force --options runtime --timestamp --sign "$identity" "$item"
    fi
    codesign --verify --strict "$item"
done

mkdir -p target/packages
package=target/packages/$name.zip
rm -f "$package"
ditto -c -k --keepParent "$stage" "$package"
if [ -n "${NOTARY_PROFILE:-}" ]; then
    xcrun notarytool submit "$package" --keychain-profile "$NOTARY_PROFILE" --wait
    # The ticket is put into the bundles, so that they open without the network; a bare program cannot carry one.
    xcrun stapler staple "$stage/Pyrophone.clap" "$stage/Pyrophone.vst3"
    rm -f "$package"
    ditto -c -k --keepParent "$stage" "$package"
fi
shasum -a 256 "$package"
