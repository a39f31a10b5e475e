# shellcheck shell=bash
# What ./run and ./test share. Sourced; all messages go to stderr, so that stdout is the program's.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

fail() {
    printf '%s: %s\n' "$(basename "$0")" "$*" >&2
    exit 1
}

# The comment at the top of the script itself.
usage() { sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0"; }

# show_progress TITLE: copies the last line of stdin onto one line of a terminal; elsewhere prints TITLE when work begins.
show_progress() {
    local line state=idle
    while IFS= read -r line; do
        if [ -t 2 ]; then
            state=line
            printf '\r\e[K%.*s' "$((${COLUMNS:-80} - 1))" "$line" >&2
        elif [ "$state" = idle ] && [[ $line != *"no work to do"* && $line != "[0/"* ]]; then
            state=told
            printf '%s\n' "$1" >&2
        fi
    done
    [ "$state" != line ] || printf '\r\e[K' >&2
}

# logged TITLE LOG COMMAND...: runs quietly into LOG with one line of progress. On failure shows what the command had to
# say: from Ninja's first FAILED line or CMake's first error on, otherwise everything.
logged() {
    local title=$1 log=$2
    shift 2
    mkdir -p "$(dirname "$log")"
    if "$@" </dev/null 2>&1 | tee "$log" | show_progress "$title"; then return; fi
    printf '%s failed (all of it in %s):\n' "$title" "$log" >&2
    if grep -qE '^(FAILED:|CMake Error)' "$log"; then
        sed -nE '/^(FAILED:|CMake Error)/,$p' "$log" >&2
    else
        cat "$log" >&2
    fi
    return 1
}

# build PRESET [TARGET...]: configures when needed, then builds. One build of a preset at a time.
build() (
    preset=$1
    shift
    dir=build/$preset
    cd "$root"
    mkdir -p "$dir"
    exec 9>"$dir/.lock"
    flock 9
    if [ ! -f "$dir/build.ninja" ] || [ CMakePresets.json -nt "$dir/build.ninja" ]; then
        logged "Configuring $preset" "$root/$dir/configure.log" cmake --preset "$preset"
        touch "$dir/build.ninja"
    fi
    targets=()
    [ $# -eq 0 ] || targets=(--target "$@")
    logged "Building $preset" "$root/$dir/build.log" cmake --build --preset "$preset" "${targets[@]}"
)

# The browser's engine (WebAssembly), the page's packages, the page.
build_web() {
    build web
    cd "$root/apps/web"
    if ! cmp -s package-lock.json node_modules/.installed-lock; then
        logged "Installing the page's npm packages" "$root/build/web/npm.log" npm ci --no-audit --no-fund
        cp package-lock.json node_modules/.installed-lock
    fi
    logged "Building the page" "$root/build/web/page.log" node_modules/.bin/vite build
}
