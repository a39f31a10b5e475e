#!/usr/bin/env bash
# The program as its users see it: exit codes, one-line messages, the files it leaves.   cli_test.sh PROGRAM
set -uo pipefail

program=$(realpath "${1:?usage: cli_test.sh PROGRAM}")
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1

checks=0
failures=0

failed() {
    printf 'FAILED: %s\n' "$*"
    failures=$((failures + 1))
}

# check NAME COMMAND...: the command succeeds.
check() {
    checks=$((checks + 1))
    local name=$1
    shift
    "$@" || failed "$name: $*"
}

# apeiron ARGUMENT...: runs the program; leaves $code, and its words in the files stdout and stderr.
apeiron() {
    "$program" "$@" >stdout 2>stderr </dev/null
    code=$?
}

# verify CODE PATTERN WHAT...: what was just run ended with CODE and said PATTERN (an extended regular expression) in one line.
verify() {
    checks=$((checks + 1))
    local wanted=$1 pattern=$2
    shift 2
    [ "$code" = "$wanted" ] || failed "$*: exit code $code, not $wanted: $(cat stderr)"
    if [ "$wanted" != 0 ]; then
        grep -qE -- "$pattern" stderr || failed "$*: no '$pattern' in: $(cat stderr)"
        [ "$(wc -l <stderr)" = 1 ] || failed "$*: more than one line: $(cat stderr)"
        grep -q '^apeiron: ' stderr || failed "$*: does not begin with 'apeiron: ': $(cat stderr)"
    else
        grep -qE -- "$pattern" stdout || failed "$*: no '$pattern' in: $(cat stdout)"
        [ ! -s stderr ] || failed "$*: said $(cat stderr)"
    fi
}

# expect CODE PATTERN ARGUMENT...
expect() {
    apeiron "${@:3}"
    verify "$@"
}

# json FILE KEY...: the value in a JSON file, by the one JSON reader that is there wherever this is built.
cat >json.cmake <<'END'
file(READ "${FILE}" text)
string(JSON value GET "${text}" ${KEYS})
message("${value}")
END
json() {
    local keys
    keys=$(printf ';%s' "${@:2}")
    cmake "-DFILE=$1" "-DKEYS=${keys:1}" -P json.cmake 2>&1
}

is_json() { json "$@" >/dev/null; }

# close A B TOLERANCE: two numbers agree relatively.
close() { awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN { d = a - b; if (d < 0) d = -d; exit !(b != 0 && d <= t * (b < 0 ? -b : b)) }'; }

small=(--size 64x36 --samples 2)

# --- Usage ---
expect 0 'Usage: apeiron' --help
expect 0 'Examples?:' render --help
for command in info check list schema merge bench; do expect 0 'Example' "$command" --help; done
expect 0 '^apeiron [0-9]+\.[0-9]+' --version
expect 2 'which command' # none at all
expect 2 "unknown command \"rendr\"; did you mean 'render'" rendr
expect 2 "unknown option \"--sise\"; did you mean --size" render mandelbulb -o a.png --sise 3x3
expect 2 'render --help' render mandelbulb
expect 2 'render --help' render -o a.png
expect 2 'not expected' render mandelbulb more -o a.png

# --- Terrain heights ---
expect 0 '^corners +-54524 -62515 -53267 -65061$' terrain height --seed 19088743 --path 33013 --kernel bilinear
expect 0 '^window +-40239 -42662 -39565 -43517$' terrain height --seed 19088743 --path 33013
apeiron terrain height --seed 19088743 --path 33013 --json
check 'terrain JSON' test "$(json stdout window 5)" = -36456
check 'terrain JSON' test "$(json stdout x)" = 27
printf '330\n13\n' >path.txt
expect 0 '^level +5$' terrain height --path @path.txt
expect 2 '--path: .*character 4 is "4"' terrain height --path 0124
expect 2 '--path: .*path2.txt: cannot be read' terrain height --path @path2.txt
head -c 1100000 /dev/zero | tr '\0' 2 >deep.txt
expect 2 '--path: an address has at most 1048576 digits' terrain height --path @deep.txt
expect 2 '--seed: expected a whole number from 0 to 4294967295' terrain height --path 1 --seed 4294967296
expect 2 "unknown kernel .*did you mean 'bilinear'" terrain height --path 1 --kernel bilinea
expect 2 '--hurst: ' terrain height --path 1 --hurst 2
expect 2 'terrain --help' terrain height
expect 0 '^scale +10\^-12.0 of the terrain.s root cell, 40 levels below it$' info terrain_range
dive() { apeiron terrain dive terrain_range -o "$1" --size 32x18 --samples 1 --fps 2 "${@:2}"; }
dive '%02d.png' --frames 3
verify 0 '^02.png  scale 10\^-1[2-9]' terrain dive
check 'dive leaves its frames' test -s 00.png -a -s 01.png -a -s 02.png -a ! -e 03.png
check 'frames of a dive differ' test "$(sha256sum <00.png)" != "$(sha256sum <02.png)"
# Each frame is a scene: the next flight goes on from there.
expect 0 '^0.jpg  scale' terrain dive 02.png -o '%d.jpg' --frames 9 --levels 0.01 --up
expect 2 "-o: .*%04d.png" terrain dive terrain_range -o 'frame.png'
expect 2 "-o: .*%04d.png" terrain dive terrain_range -o '%s.png'
expect 2 'only terrain has an autopilot' terrain dive mandelbulb -o '%d.png'
expect 2 '--levels: expected a number greater than 0' terrain dive terrain_range -o '%d.png' --levels 0

# --- Scenes ---
expect 2 "did you mean 'mandelbulb'" render mandelbul -o a.png
expect 2 'none.json: there is no such file' render none.json -o a.png
mkdir empty
expect 2 'is a folder without DICOM or TIFF files' render ./empty -o a.png
printf '{\n  "camera": {\n    "fov": 40,,\n  }\n}\n' >broken.json
expect 2 'broken.json:3:' render broken.json -o a.png
printf '{\n  "camera": {\n    "fof": 40\n  }\n}\n' >key.json
expect 2 "key.json:3 .*fof.*did you mean 'fov'" render key.json -o a.png
printf '{\n  "camera": {\n    "fov": 4000\n  }\n}\n' >range.json
expect 2 'range.json:3 .*4000' render range.json -o a.png
printf '{ "apeiron": 99 }' >newer.json
expect 2 'newer' render newer.json -o a.png
printf 'not a picture' >text.png
expect 2 'text.png:1' render text.png -o a.png
expect 2 'empty' render '' -o a.png

# --- Values ---
for size in 12 axb 0 x 64x 64x36x2 '64 x 36'; do
    expect 2 "--size: expected WIDTHxHEIGHT" render mandelbulb -o a.png --size "$size"
done
expect 2 '--size: width: -5 ' render mandelbulb -o a.png --size -5x5
expect 2 '--size: height: 0 ' render mandelbulb -o a.png --size 5x0
expect 2 '--size: width: 100000 ' render mandelbulb -o a.png --size 100000x100000
expect 2 '--size: width: ' render mandelbulb -o a.png --size 99999999999999999999x2
expect 2 '--samples: ' render mandelbulb -o a.png --samples 0
expect 2 '--samples: expected a whole number' render mandelbulb -o a.png --samples many
expect 2 '--time: ' render mandelbulb -o a.png --time -1
expect 2 '--noise: ' render mandelbulb -o a.png --noise nan
expect 2 '--seed: ' render mandelbulb -o a.png --seed -1
expect 2 '--first-sample: ' render mandelbulb -o a.png --first-sample 1.5
expect 2 '--bits: expected 8 or 16' render mandelbulb -o a.png --bits 10
expect 2 '--budget: ' render mandelbulb -o a.png --budget 0
expect 2 '--tile: ' render mandelbulb -o a.png --tile 0
expect 2 "--stage: .*did you mean 'compute'" render mandelbulb -o a.png --stage compute2
expect 2 '--device: ' render mandelbulb -o a.png --device gpu
expect 2 '--device: no device 999' render mandelbulb -o a.png --device 999
expect 2 "--set: .*did you mean 'power'" render mandelbulb -o a.png --set subject.powr=3
expect 2 '--set: expected PATH=VALUE' render mandelbulb -o a.png --set subject.power

# --- Outputs, which are looked at before any work is done ---
expect 2 "a.foo: cannot write '.foo'; known: .png .jpg .exr" render mandelbulb -o a.foo
expect 2 'no extension' render mandelbulb -o a
expect 2 'the folder does not exist' render mandelbulb -o none/a.png
mkdir folder.png
expect 2 'folder.png: is a folder' render mandelbulb -o folder.png
expect 2 'the folder does not exist' render mandelbulb -o a.png --stats none/s.json
mkdir locked && chmod a-w locked
if [ "$(id -u)" != 0 ]; then expect 2 'locked/a.png: cannot be written' render mandelbulb -o locked/a.png; fi
check 'nothing was rendered so far' test ! -e a.png

# --- Formulas of one's own ---
cp "$root/src/fractal/formulas/mandelbulb.glsl" mine.glsl
expect 0 'a.png' render mandelbulb -o a.png "${small[@]}" --set subject.formula=./mine.glsl
line=$(grep -n 'void iterate' mine.glsl | cut -d: -f1)
sed "${line}a     float wrong = undeclared_name;" mine.glsl >bad.glsl
apeiron render mandelbulb -o b.png "${small[@]}" --set subject.formula=./bad.glsl
check 'a bad formula is wrong input' test "$code" = 2
check 'its place is told' grep -q "bad.glsl:$((line + 1))" stderr
check 'in the words of the compiler' grep -q 'undeclared_name' stderr
expect 2 'none.glsl' render mandelbulb -o b.png --set subject.formula=./none.glsl
check 'nothing was written' test ! -e b.png
# A picture carries the formula's source: it renders without the file.
rm mine.glsl
expect 0 'again.png' render a.png -o again.png
check 'a picture with a formula renders again' cmp a.png again.png

# --- No GPU ---
env -i "PATH=$PATH" __EGL_VENDOR_LIBRARY_DIRS=/nonexistent __EGL_VENDOR_LIBRARY_FILENAMES= \
    "$program" render mandelbulb -o b.png >stdout 2>stderr
code=$?
verify 3 'no usable GPU context|no EGL device' 'rendering without a GPU'
env -i "PATH=$PATH" __EGL_VENDOR_LIBRARY_DIRS=/nonexistent __EGL_VENDOR_LIBRARY_FILENAMES= \
    "$program" check mandelbulb >stdout 2>stderr
code=$?
verify 0 'mandelbulb: ok' 'checking without a GPU'

# --- Pictures ---
expect 0 '^a.png  64x36, 3 samples, .* s on ' render mandelbulb --size 64x36 --samples 3 \
    -o a.png -o a.jpg -o a.exr -o deep.PNG --bits 16 --stats stats.json
for file in a.png a.jpg a.exr deep.PNG; do check "$file is there" test -s "$file"; done
check 'stats are JSON' is_json stats.json phases render cpu_ms
check 'stats count samples' test "$(json stats.json samples)" = 3
check 'stats count pixels' test "$(json stats.json pixels)" = $((64 * 36 * 3))
for key in apeiron device driver software stage width height noise seed wall_s samples_per_second submissions \
    longest_submission_ms peak_memory_bytes; do
    check "stats have $key" is_json stats.json "$key"
done
for phase in start context compile render generate integrate present post read write; do
    check "stats have the phase $phase" is_json stats.json phases "$phase" wall_ms
done
apeiron render mandelbulb "${small[@]}" -o quiet.png --quiet
check 'quiet is quiet' test ! -s stdout -a ! -s stderr

# Every picture renders again from itself, bit by bit.
for file in a.png a.jpg a.exr deep.PNG; do
    expect 0 again render "$file" -o again.png -o again.jpg --bits 8
    expect 0 again render "$file" -o again16.png --bits 16
    check "$file renders again as it was" cmp again.jpg a.jpg
    check "$file renders again as it was, with 16 bits" cmp again16.png deep.PNG
done
"$program" render - -o stdin.png "${small[@]}" <"$root/scenes/mandelbulb.json" >stdout 2>stderr
code=$?
verify 0 stdin.png 'a scene from standard input'
expect 0 stdin.png render mandelbulb -o named.png "${small[@]}" -o stdin.png
check 'standard input, name and file are the same scene' cmp stdin.png named.png

# Another seed is another picture; the same one, in other portions and on the other stage, is the same.
expect 0 seed render mandelbulb -o seed.png "${small[@]}" --seed 7
check 'the seed matters' test "$(cmp -s seed.png named.png; echo $?)" = 1
expect 0 tile render mandelbulb -o tile.png "${small[@]}" --tile 100 --budget 1
check 'portions do not matter' cmp tile.png named.png
expect 0 time render mandelbulb -o time.png --size 64x36 --time 0.3
check 'time alone is the limit' test "$("$program" info time.png | grep -c ' 10000000 samples')" = 0
expect 0 noise render mandelbulb -o noise.exr --size 32x18 --noise 0.2

# --- Merging ---
expect 0 whole.exr render mandelbulb -o whole.exr --size 64x36 --samples 8
expect 0 one.exr render mandelbulb -o one.exr --size 64x36 --samples 5
expect 0 two.exr render mandelbulb -o two.exr --size 64x36 --samples 3 --first-sample 5
expect 0 '8 samples of 2 files' merge one.exr two.exr -o merged.exr
"$program" info merged.exr --json >merged.json
"$program" info whole.exr --json >whole.json
# Sums of floats in another order: their rounding errors.
for key in mean_luminance noise mean_coverage; do
    check "merged $key" close "$(json merged.json image "$key")" "$(json whole.json image "$key")" 1e-5
done
check 'merged samples' test "$(json merged.json image samples)" = 8
expect 0 again render merged.exr -o again.png
expect 0 whole render whole.exr -o whole.png
check 'a merged picture renders again like the whole' cmp again.png whole.png
expect 2 'would count twice' merge one.exr one.exr -o twice.exr
expect 2 'would count twice' merge merged.exr two.exr -o twice.exr
expect 0 other.exr render mandelbulb -o other.exr --size 64x36 --samples 2 --first-sample 8 --set subject.power=7
expect 2 'other.exr: shows another scene than one.exr: /subject/power differs' merge one.exr other.exr -o twice.exr
expect 0 other.exr render mandelbulb -o other.exr --size 32x18 --samples 2 --first-sample 8
expect 2 'other.exr: ' merge one.exr other.exr -o twice.exr
expect 2 'EXR files only' merge one.exr two.exr -o twice.png
expect 2 'at least two' merge one.exr -o twice.exr
expect 2 'finished picture' merge one.exr a.png -o twice.exr
expect 2 'none.exr: there is no such file' merge one.exr none.exr -o twice.exr
head -c 3000 one.exr >short.exr
expect 2 'short.exr: ' merge two.exr short.exr -o twice.exr
check 'nothing was merged' test ! -e twice.exr

# --- Interrupted ---
"$program" render mandelbulb -o stopped.png -o stopped.exr --size 64x36 --samples 10000000 >stdout 2>stderr &
process=$!
sleep 2
kill -INT "$process"
wait "$process"
code=$?
verify 130 'interrupted after [0-9]+ of 10000000 samples; saved stopped.png, stopped.exr' 'interrupted'
expect 0 'again.png' render stopped.exr -o again.png --samples 1
expect 0 'stopped.png: ok' check stopped.png
check 'what was saved says how many samples' test "$("$program" info stopped.png | grep -c ' 10000000 samples')" = 0

# --- A full disk ---
printf 'old' >full.jpg
for file in full.png full.jpg full.exr; do
    (
        trap '' XFSZ
        ulimit -f 8
        "$program" render mandelbulb -o "$file" --size 400x300 --samples 1 >stdout 2>stderr
    )
    code=$?
    verify 2 'cannot be written' "a full disk: $file"
done
check 'the old file is still there' test "$(cat full.jpg)" = old
check 'no new one is' test ! -e full.png -a ! -e full.exr

# --- What there is ---
for kind in scenes subjects formulas renderers effects tonemappers environments palettes devices; do
    expect 0 . list "$kind"
    "$program" list "$kind" --json >list.json
    check "list $kind is JSON" is_json list.json 0 name
done
expect 2 "did you mean 'formulas'" list formulae
expect 0 '"roles"' schema --json
cp stdout schema.json
check 'the schema is JSON' is_json schema.json modules formulas mandelbulb parameters 0 name
"$program" bench mandelbulb --size 32x18 --samples 1 --json >bench.json
check 'bench is JSON' is_json bench.json 0 samples_per_second
expect 0 'Msamples/s' bench mandelbulb --size 32x18 --samples 1
expect 0 '^# Parameters' schema
if [ -e "$root/docs/parameters.md" ]; then
    check 'docs/parameters.md is current; make it by: apeiron schema >docs/parameters.md' \
        cmp stdout "$root/docs/parameters.md"
fi
expect 0 '^formula|subject .*mandelbulb' info mandelbulb
"$program" info a.png --json >info.json
check 'info is JSON' test "$(json info.json image width)" = 64
expect 2 'text.png' info text.png
"$program" check mandelbulb key.json range.json a.png >stdout 2>stderr
code=$?
check 'check looks at all scenes' test "$code" = 2 -a "$(wc -l <stdout)" = 2 -a "$(wc -l <stderr)" = 2
expect 0 ok check "$root"/scenes/*.json

# --- Focus ---
expect 2 'pinhole camera has no focus' render mandelbulb -o f.png --size 64x36 --samples 1 --focus 0.5,0.5
expect 2 'expected X,Y' render mandelbulb -o f.png --size 64x36 --set camera.aperture=0.1 --focus middle
expect 2 '64,1 is outside the picture of 64x36' render mandelbulb -o f.png --size 64x36 --set camera.aperture=0.1 --focus 64,1
expect 2 'nothing but background at pixel 0,0' render mandelbulb -o f.png --size 64x36 --set camera.aperture=0.1 --focus 0,0
for place in 32,18 0.5,0.5; do
    expect 0 '1 sample' render mandelbulb -o f.png --size 64x36 --samples 1 --set camera.aperture=0.1 --focus $place
    "$program" info f.png --json >focus.json
    # The camera is 2.96 from its target; the bulb's surface comes to meet it.
    check "the focus of $place is saved with the picture" \
        awk "BEGIN { f = $(json focus.json scene camera focus); exit !(f > 0.8 && f < 2.8) }"
done

# --- Volumes ---
# Four voxels of each of two channels: 0 1 2 3, 4 5 6 7.
printf '\000\001\002\003\004\005\006\007' >v.raw
form=2x2x1:uint8:channels=2:spacing=0.5x0.5x2
expect 0 '^size +2x2x1 voxels, uint8' info v.raw --raw $form
expect 0 '^spacing +0.5 x 0.5 x 2 mm' info v.raw --raw $form
expect 0 '^channel 1 +4 to 7, mean 5.5' info v.raw --raw $form
apeiron info v.raw --raw $form --json
cp stdout volume.json
check 'a volume has a size' test "$(json volume.json volume size 1)" = 2
check 'a volume has channels' test "$(json volume.json volume channels)" = 2
check 'a volume has points of time' test "$(json volume.json volume times)" = 1
check 'a volume has an orientation' test "$(json volume.json volume orientation)" = LPS
check 'a volume has a range' test "$(json volume.json volume values 1 max)" = 7.0
check 'a volume has percentiles' test "$(json volume.json volume values 0 percentiles 50)" = 1.0
# Its middle is the mean of all four; voxels are centred at -0.25 and 0.25 mm.
expect 0 '^channel 1 +5.5$' info v.raw --raw $form --at 0,0,0
expect 0 '^channel 0 +1$' info v.raw --raw $form --at 0.25,-0.25,0
expect 0 '^voxel +\(0, 1, 0\)' info v.raw --raw $form --at -0.5,0.5,0.9
expect 2 '\(0, 0, 1.5\) mm is outside .* corners are at \(-0.5, -0.5, -1\)' info v.raw --raw $form --at 0,0,1.5
expect 2 'this is none' info mandelbulb --at 0,0,0
expect 0 'channel 1: 4 voxels' info v.raw --raw $form --histogram
apeiron info v.raw --raw $form --at 0,0,0 --histogram --json
cp stdout questions.json
check 'a place has values' test "$(json questions.json at values 0 value)" = 1.5
check 'a histogram counts voxels' test "$(json questions.json histograms 1 values voxels)" = 4
expect 2 'v.raw: has 8 bytes, and 3x3x1:uint8 needs 9' info v.raw --raw 3x3x1:uint8
expect 2 'v.raw: .* need .* GB, and there are' info v.raw --raw 60000x60000x60000:float32
printf 'ObjectType = Image\nNDims = 3\nDimSize = 60000 60000 60000\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n' >huge.mha
expect 2 'huge.mha: its header asks for .* GB of memory' info huge.mha
printf 'ObjectType = Image\nNDims = 99\nDimSize = 1\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n' >bad.mha
expect 2 'bad.mha: NDims' info bad.mha
# A volume that is larger than the memory for it: read in parts.
{ head -c 1048576 /dev/zero | tr '\0' x; head -c 1048576 /dev/zero; } >large.raw
printf '{ "subject": {"type": "volume", "source": "large.raw", "raw": "128x128x128:uint8"}, "renderer": {"type": "mip"} }' >large.json
apeiron render large.json -o large.png --size 16x16 --samples 1 --memory 1M
check 'what is larger than the memory for it is rendered' grep -q 'large.png  16x16' stdout
check 'a note says that not all is shown' grep -q 'note: 128x128x128 voxels are more than the memory' stderr
expect 2 'large.raw: 128x128x128 voxels cannot be shown with .* MB of memory; allow .* MB at least' \
    render large.json -o large.png --size 16x16 --memory 64K
expect 2 '^apeiron: --memory: expected a number of bytes such as 256M or 2G' render large.json -o large.png --memory many
expect 2 '^apeiron: --memory: a fractal has no limit of memory' render mandelbulb -o large.png --memory 1M
head -c 2097151 large.raw >short.raw
expect 2 'short.raw: has 2097151 bytes, and .* needs 2097152' render large.json -o large.png --memory 1M --set subject.source=short.raw

# A scene names its volume from its own folder, wherever the program is started.
mkdir scene
head -c 4096 /dev/zero >scene/even.raw
{ head -c 2048 /dev/zero | tr '\0' x; head -c 2048 /dev/zero; } >scene/ball.raw
printf '{ "subject": {"type": "volume", "source": "ball.raw", "raw": "16x16x16:uint8"}, "renderer": {"type": "mip"} }' >scene/ball.json
expect 0 ball.png render scene/ball.json -o ball.png --size 32x32 --samples 1
apeiron render scene/ball.json -o ball.png --size 32x32 --samples 1 --set subject.source=./none.raw
verify 2 'none.raw' 'a volume that is not there'
apeiron render scene/ball.json -o ball.png --size 32x32 --samples 1 --set subject.source=scene/even.raw
check 'an empty picture says why' grep -q 'nothing of the volume is in view' stderr

# --- Nothing half-written is left ---
check 'no temporary files' test -z "$(find . -name '.apeiron*')"

printf '%d checks, %d failed\n' "$checks" "$failures"
[ "$failures" = 0 ]
