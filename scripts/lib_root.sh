# shellcheck shell=bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Sourced by the scripts that try things in a fresh Debian of the same release (debootstrap, a folder):
# make_root, inside. The bare system is kept in GLISSADE_DEBIAN_TARBALL (build/debian-CODENAME.tar), and
# taken from there the next time. Says why, and exits 0, where this cannot be done: not root, no network,
# no Debian.
source "$(dirname "${BASH_SOURCE[0]}")/lib_setup.sh"

skip() {
  say "SKIPPED: $*"
  exit 0
}

timed() { # WHAT COMMAND...: the seconds of it; what it prints only where it fails
  local what=$1 start=$SECONDS
  shift
  if ! "$@" >"$work/log" 2>&1 </dev/null; then
    tail -n 30 "$work/log" >&2
    die "$what failed (the end of its output is above)"
  fi
  say "$what: $((SECONDS - start)) s"
}

make_root() { # a bare system in $root, a folder of $work, which goes when the script ends
  ((EUID == 0)) || skip "a Debian in a folder is made and entered by root only"
  local codename tarball mirror
  codename=$(. /etc/os-release && [[ $ID == debian ]] && echo "$VERSION_CODENAME") ||
    skip "packages depend on those of the system that they are built on, and this is no Debian"
  unshare --mount true 2>/dev/null || skip "no mount namespace can be made here (a container without the right)"
  need_packages --optional debootstrap
  command -v debootstrap >/dev/null || skip "there is no debootstrap, and it cannot be installed"
  mkdir -p build
  work=$(mktemp -d "$PWD/build/root.XXXXXX")
  trap 'rm -rf --one-file-system "$work"' EXIT
  root=$work/root
  tarball=${GLISSADE_DEBIAN_TARBALL:-$PWD/build/debian-$codename.tar}
  mirror=$(sed -nE 's/^(URIs:|deb( \[[^]]*\])?) +(https?:[^ ]+).*/\3/p' /etc/apt/sources.list /etc/apt/sources.list.d/* \
    2>/dev/null | grep -v security | head -n 1 || true)
  if [[ -f $tarball ]]; then
    timed "a bare $codename from $(basename "$tarball")" eval 'mkdir "$root" && tar -C "$root" -xf "$tarball"'
  else
    if ! debootstrap --variant=minbase "$codename" "$root" "${mirror:-http://deb.debian.org/debian}" >"$work/log" 2>&1; then
      tail -n 3 "$work/log" >&2
      skip "debootstrap could not make a $codename here (no network, or a container that may not make devices)"
    fi
    say "a bare $codename by debootstrap: $SECONDS s since the start"
    tar -C "$root" -cf "$tarball.part" . && mv "$tarball.part" "$tarball"
  fi
  cp /etc/resolv.conf "$root/etc/" 2>/dev/null || true
  # As in a container, nothing is started; and a root that is thrown away needs no fsync.
  printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d"
  chmod +x "$root/usr/sbin/policy-rc.d"
  echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/unsafe-io"
  mkdir -p "$root/try"
  inside true || skip "/proc cannot be mounted in the new system"
  timed "apt-get update" inside apt-get update -q
}

inside() { # COMMAND...: in the new system, with a /proc of its own that goes when it ends
  unshare --mount bash -c '
    mount -t proc proc "$0/proc" 2>/dev/null || mount --rbind /proc "$0/proc" || exit 1
    root=$0
    exec chroot "$root" /usr/bin/env -i HOME=/root TERM=dumb LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
      PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$@"' "$root" "$@"
}
install=(apt-get install -y -q --no-install-recommends)
