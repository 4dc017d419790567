# Homebrew: brew install --HEAD packaging/homebrew/brio.rb, from a checkout. For a release: url and sha256 of its archive instead of head.
class Brio < Formula
  desc "Exact Delaunay and regular triangulations, and surfaces from points"
  homepage "https://example.org/brio"
  license "MIT"
  head "file://#{File.expand_path("../..", __dir__)}", using: :git, branch: "main"

  depends_on "cmake" => :build
  depends_on "cjson"
  depends_on "expat"
  depends_on "zstd"
  uses_from_macos "zlib"

  def install
    system "cmake", "-S", ".", "-B", "build", "-DBUILD_SHARED_LIBS=ON", "-DBRIO_TESTS=OFF", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    system bin/"brio", "generate", "sphere", "-n", "1000", "-o", "sphere.ply"
    assert_match "\"closed\":true", shell_output("#{bin}/brio surface sphere.ply -o surface.ply --json").delete(" ")
  end
end
