# shellcheck shell=bash
# Functions that the scripts share: they find out what is missing and install it.
#
#   want DEBIAN FEDORA ARCH CHECK...   notes the packages unless the command CHECK... succeeds
#   install_wanted                     installs what was noted, or names it and ends
#
# "-" stands for "comes with another package". DEBIAN may hold several packages.

PATH=$PATH:/usr/sbin:/sbin # where ldconfig may be
missing_debian=() missing_fedora=() missing_arch=()

say() { printf '%s: %s\n' "$(basename "$0")" "$*" >&2; }
fail() { say "$@"; exit 1; }
heading() { printf '\n--- %s\n' "$*" >&2; }
have() { command -v "$1" >/dev/null 2>&1; }
# True if the dynamic linker finds a shared library.
has_library() { ldconfig -p 2>/dev/null | grep -F "$1" >/dev/null; }

# True if a file matches one of the patterns.
has_file() {
  local file
  for file in "$@"; do [ -e "$file" ] && return 0; done
  return 1
}
has_vulkan_driver() {
  [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ] ||
    has_file /usr/share/vulkan/icd.d/*.json /etc/vulkan/icd.d/*.json /usr/local/share/vulkan/icd.d/*.json
}
has_radv() { has_file /usr/share/vulkan/icd.d/radeon_icd*.json /etc/vulkan/icd.d/radeon_icd*.json; }
has_lavapipe() { has_file /usr/share/vulkan/icd.d/lvp_icd*.json /etc/vulkan/icd.d/lvp_icd*.json; }
has_validation_layer() {
  has_file /usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json \
    /etc/vulkan/explicit_layer.d/VkLayer_khronos_validation.json
}
# True if there is a manifest by which programs find the active OpenXR runtime.
has_openxr_runtime() {
  local manifest=openxr/1/active_runtime.json
  has_file "${XR_RUNTIME_JSON:-/nowhere}" "${XDG_CONFIG_HOME:-$HOME/.config}/$manifest" "/etc/xdg/$manifest" \
    "/usr/share/$manifest" "/usr/local/share/$manifest"
}
has_display() { [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; }

want() {
  local debian=$1 fedora=$2 arch=$3
  shift 3
  "$@" && return
  read -ra debian <<<"$debian"
  missing_debian+=("${debian[@]}")
  [ "$fedora" = - ] || missing_fedora+=("$fedora")
  [ "$arch" = - ] || missing_arch+=("$arch")
}

# Wants Rust and a linker, and the Vulkan loader.
want_basics() {
  have cargo || fail "Rust is missing; install it from https://rustup.rs, then run this again"
  want "gcc libc6-dev" gcc gcc have cc
  want libvulkan1 vulkan-loader vulkan-icd-loader has_library libvulkan.so.1
}

# Wants the libraries that a window on X11 opens at run time.
want_window_libraries() {
  want libx11-6 libX11 libx11 has_library libX11.so.6
  want libx11-xcb1 libX11-xcb - has_library libX11-xcb.so.1
  want libxcursor1 libXcursor libxcursor has_library libXcursor.so.1
  want libxi6 libXi libxi has_library libXi.so.6
  want libxrandr2 libXrandr libxrandr has_library libXrandr.so.2
  want libxkbcommon-x11-0 libxkbcommon-x11 libxkbcommon-x11 has_library libxkbcommon-x11.so.0
}

install_wanted() {
  [ ${#missing_debian[@]} -gt 0 ] || return 0
  if have apt-get && have dpkg; then
    install_with_apt "${missing_debian[@]}"
  elif have dnf; then
    fail "missing: ${missing_fedora[*]}; install with: sudo dnf install ${missing_fedora[*]}"
  elif have pacman; then
    fail "missing: ${missing_arch[*]}; install with: sudo pacman -S ${missing_arch[*]}"
  else
    fail "missing, by their names in Debian: ${missing_debian[*]}; install your system's packages for them"
  fi
}

install_with_apt() {
  local root=()
  if [ "$(id -u)" -ne 0 ]; then
    have sudo || fail "missing: $*; as root: apt-get install $*"
    root=(sudo)
  fi
  say "installing with apt-get${root:+ (sudo may ask for your password)}: $*"
  # Lists of a mirror that fails may be old, but often good enough.
  "${root[@]}" apt-get update -qq || say "apt-get update failed; going on with the lists there are"
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >&2 ||
    fail "apt-get could not install: $*"
}
