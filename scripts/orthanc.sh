#!/bin/sh
# Prints the path of Orthanc, the DICOMweb server that tests of import ask, once its plugin is there.
#
# In this order: one in PATH, Debian's own (installed here where we are root; it is not started).
# Where there is none the tests that need it are left out, and the end of the run says why.
set -eu

PLUGIN=/usr/share/orthanc/plugins/libOrthancDicomWeb.so

find_orthanc() {
    [ -e "$PLUGIN" ] || return 1
    command -v Orthanc || { [ -x /usr/sbin/Orthanc ] && echo /usr/sbin/Orthanc; }
}

find_orthanc && exit 0

if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "installing Debian's orthanc and orthanc-dicomweb for the tests of import" >&2
    apt-get update -qq >&2
    RUNLEVEL=1 DEBIAN_FRONTEND=noninteractive \
        apt-get install -y -qq --no-install-recommends orthanc orthanc-dicomweb >&2
    find_orthanc && exit 0
fi
echo "missing: Orthanc with its DICOMweb plugin, for the tests of import" >&2
echo "    get it: apt install orthanc orthanc-dicomweb" >&2
exit 1
