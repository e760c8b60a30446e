#!/usr/bin/env bash
# Makes sure that Dr.Jit finds an LLVM it can work with (16 or newer) for the llvm_* variants.
# Versions 14 and 15 crash in Mitsuba 3.9.1 ("Cannot select fminimum"). Without root or
# password-less sudo, or without apt, it only says what is missing: the rest works without.
set -euo pipefail

oldest=16
preferred=(19 18 17 16 20 21)

# Newest libLLVM that the dynamic linker knows; 0 if none.
installed() {
    { ldconfig -p || /sbin/ldconfig -p; } 2>/dev/null |
        sed -nE 's/^\s*libLLVM(-|\.so\.)([0-9]+).*/\2/p' | sort -n | tail -n 1 | grep . || echo 0
}

if [[ -n "${DRJIT_LIBLLVM_PATH:-}" ]]; then
    echo "== LLVM: $DRJIT_LIBLLVM_PATH, as DRJIT_LIBLLVM_PATH says"
    exit 0
fi
if (($(installed) >= oldest)); then
    echo "== LLVM: version $(installed) found"
    exit 0
fi

as_root=()
((EUID == 0)) || as_root=(sudo -n)
if command -v apt-get >/dev/null && { ((EUID == 0)) || sudo -n true 2>/dev/null; }; then
    "${as_root[@]}" apt-get update -qq || true
    for version in "${preferred[@]}"; do
        if apt-cache show "libllvm$version" >/dev/null 2>&1; then
            echo "== LLVM: installing libllvm$version from the system's packages"
            "${as_root[@]}" apt-get install -y -qq --no-install-recommends "libllvm$version" && exit 0
        fi
    done
fi

echo "== LLVM: no version >= $oldest found and none could be installed (Debian: apt install libllvm19)." \
    "Mitsuba's llvm_* variants are skipped; set DRJIT_LIBLLVM_PATH if yours is in an unusual place."
