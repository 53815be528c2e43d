# Completion of plumb in fish. Copy this file to ~/.config/fish/completions. plumb __complete finds the
# candidates.
function __plumb_complete
    set -l words (commandline -opc)
    set -l program (string replace -r '^~/' "$HOME/" -- $words[1])
    set -e words[1]
    set -l word (commandline -ct | string unescape)
    for line in ($program __complete $words "$word" 2>/dev/null)
        if set -l suffix (string replace -f ':files ' '' -- $line)
            set -l option (string match -r -- '^--[^=]*=' $word)
            set -l files (__fish_complete_path (string replace -r -- '^--[^=]*=' '' $word))
            string match -r -- ".*(?:/|$(string escape --style=regex -- $suffix))(?:\t.*)?\$" "$option"$files
        else
            echo $line
        end
    end
end
complete -c plumb -f -a '(__plumb_complete)'
