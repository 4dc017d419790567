# formula.rb FORMULA OUT: stands for Homebrew. The words of a formula are noted, and its install and test run, with the options that
# Homebrew gives to CMake.
require "pathname"

module Words
  attr_reader :words, :trial

  %i[desc homepage license head url sha256 depends_on uses_from_macos].each do |name|
    define_method(name) { |*given| ((@words ||= {})[name] ||= []) << given }
  end

  def test(&block)
    @trial = block
  end
end

class Formula
  extend Words
  attr_reader :prefix

  def initialize(prefix)
    @prefix = Pathname(prefix)
  end

  def bin
    prefix/"bin"
  end

  def std_cmake_args
    %W[-DCMAKE_INSTALL_PREFIX=#{prefix} -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_BUILD_TYPE=Release -DCMAKE_FIND_FRAMEWORK=LAST
       -DBUILD_TESTING=OFF -Wno-dev]
  end

  def system(*words)
    super(*words.map(&:to_s), out: File::NULL) || raise("failed: #{words.join(" ")}")
  end

  def shell_output(line)
    text = `#{line}`
    raise "failed: #{line}" unless $?.success?

    text
  end

  def assert_match(pattern, text)
    raise "no #{pattern.inspect} in #{text}" unless text.match?(pattern.is_a?(String) ? Regexp.escape(pattern) : pattern)
  end
end

formula, out = ARGV.map { |name| File.expand_path(name) }
load formula
words = Brio.words
raise "desc is too long, ends with a period or names the formula" if words[:desc][0][0].match?(/\A.{81}|[.]\z|\Abrio/i)
raise "neither url with sha256 nor head" unless words[:head] || (words[:url] && words[:sha256])

brio = Brio.new("#{out}/prefix")
source = Dir.pwd
Dir.chdir(out) do
  Dir.mkdir("source") # a formula builds in a folder of its own
  Kernel.system("git", "-C", source, "checkout-index", "-a", "--prefix=#{out}/source/") || raise("no sources")
  Dir.chdir("source") { brio.install }
  Dir.mkdir("trial")
  Dir.chdir("trial") { brio.instance_eval(&Brio.trial) }
end
puts "built, installed and tested by stand-ins of its words"
