#!/bin/sh
# old_root.sh OLD TREE PROGRAM [ARGUMENT ...]: runs a program in the folder OLD as if it were the whole system, where this machine's
# devices, processes, temporary files, the source tree TREE and its ../shared are seen at their own places. Root alone can do that.
# What it mounts it mounts in a view of files that ends with it (unshare -m), and it starts no process that outlives the program.
set -eu

[ "$1" = --apart ] || exec unshare -m sh "$0" --apart "$@"
shift
old=$1 tree=$2
shift 2
for seen in /dev /proc "${TMPDIR:-/tmp}" "$tree" "$tree/../shared"; do
    [ -d "$seen" ] || continue
    seen=$(cd "$seen" && pwd -P)
    [ -d "$old$seen" ] || mkdir -p "$old$seen"
    mount --rbind "$seen" "$old$seen"
done
exec chroot "$old" /bin/sh -c 'cd "$0" && exec "$@"' "$PWD" "$@"
