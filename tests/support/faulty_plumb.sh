# Sourced: plumb with a fault in its own engine, from $SOURCE and $BUILD, in $directory.
ninja -C "$BUILD" -t commands plumb >"$directory/commands" || exit 77 # another generator

fail() {
    echo "$*" >&2
    exit 1
}

# faulty NAME FILE SED: NAME becomes a plumb whose FILE has the change, compiled and linked as the build
# does, its object before the libraries and so in place of theirs.
faulty() {
    local name=$directory/$1 file=$SOURCE/$2 compile link
    sed "$3" "$file" >"$name.c"
    ! cmp -s "$file" "$name.c" || fail "$2: \"$3\" changes nothing"
    compile=$(grep -F -- "-c $file" "$directory/commands")
    compile=${compile%" -c $file"*}
    compile=$(sed -E 's/ -(o|MF|MT) [^ ]+//g; s/ -MD\b//' <<<"$compile")
    link=$(tail -n 1 "$directory/commands")
    (cd "$BUILD" && eval "$compile -I$(dirname "$file") -c $name.c -o $name.o" &&
        eval "${link/ -o plumb / $name.o -o $name }") || fail "$1 does not build"
}
