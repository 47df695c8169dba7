//! Output files: they appear completely, keep owner, mode and links, and leave no temporary file.

use std::fs::{self, File};
use std::io::{self, Write as _};

use recording::{AtomicFile, FileIdentity, write_file_atomically};

#[test]
fn a_file_appears_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    let entries = || fs::read_dir(folder.path()).unwrap().count();

    write_file_atomically(&path, |file| file.write_all(b"first")).unwrap();
    assert_eq!(
        (fs::read(&path).unwrap(), entries()),
        (b"first".to_vec(), 1)
    );

    let failed: io::Result<()> = write_file_atomically(&path, |file| {
        file.write_all(&[b'x'; 1 << 20])?;
        Err(io::Error::other("the simulation failed"))
    });
    assert!(failed.is_err());
    assert_eq!(
        (fs::read(&path).unwrap(), entries()),
        (b"first".to_vec(), 1)
    );

    let mut dropped = AtomicFile::create(&path).unwrap();
    dropped.write_all(b"half").unwrap();
    dropped.flush().unwrap();
    assert_eq!(entries(), 2, "the unfinished file is in the same folder");
    drop(dropped);
    assert_eq!(
        (fs::read(&path).unwrap(), entries()),
        (b"first".to_vec(), 1)
    );

    let mut second = AtomicFile::create(&path).unwrap();
    second.write_all(b"second").unwrap();
    second.commit().unwrap();
    assert_eq!(
        (fs::read(&path).unwrap(), entries()),
        (b"second".to_vec(), 1)
    );

    assert!(
        AtomicFile::create(folder.path()).is_err(),
        "a folder is no file"
    );
    assert!(AtomicFile::create(folder.path().join("absent/log.csv")).is_err());
}

#[cfg(unix)]
#[test]
fn an_output_behind_a_link_is_written_there_and_is_readable_by_others() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let (target, link) = (
        folder.path().join("target.csv"),
        folder.path().join("link.csv"),
    );
    fs::write(&target, b"old").unwrap();
    let plain = fs::metadata(&target).unwrap().permissions().mode();
    std::os::unix::fs::symlink(&target, &link).unwrap();
    write_file_atomically(&link, |file| file.write_all(b"new")).unwrap();
    assert_eq!(fs::read(&target).unwrap(), b"new");
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::metadata(&target).unwrap().permissions().mode(), plain);
}

#[cfg(unix)]
#[test]
fn a_file_that_is_replaced_keeps_its_mode() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    fs::write(&path, b"old").unwrap();
    for mode in [0o600, 0o640, 0o666, 0o755] {
        fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
        write_file_atomically(&path, |file| file.write_all(b"new")).unwrap();
        assert_eq!(
            fs::metadata(&path).unwrap().permissions().mode() & 0o777,
            mode
        );
    }
}

/// Longer and shorter contents: the file is written in place.
#[cfg(unix)]
#[test]
fn all_names_of_a_file_that_is_replaced_have_the_new_content() {
    let folder = tempfile::tempdir().unwrap();
    let [path, other] = ["log.csv", "other.csv"].map(|name| folder.path().join(name));
    fs::write(&path, b"older").unwrap();
    fs::hard_link(&path, &other).unwrap();
    for content in ["much longer than before", "short", ""] {
        write_file_atomically(&path, |file| file.write_all(content.as_bytes())).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), content);
        assert_eq!(fs::read_to_string(&other).unwrap(), content);
        assert_eq!(FileIdentity::of(&path), FileIdentity::of(&other));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}

#[test]
fn a_write_protected_file_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    fs::write(&path, b"old").unwrap();
    let mut permissions = fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).unwrap();
    let refused = AtomicFile::create(&path).unwrap_err();
    assert_eq!(refused.kind(), io::ErrorKind::PermissionDenied);
    assert!(refused.to_string().contains("write-protected"), "{refused}");
}

#[test]
fn a_new_file_replaces_none_not_even_one_that_came_in_the_meantime() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    let mut file = AtomicFile::create_new(&path).unwrap();
    file.write_all(b"ours").unwrap();
    fs::write(&path, b"theirs").unwrap();
    let kind = |refused: io::Error| refused.kind();
    assert_eq!(
        file.commit().map_err(kind),
        Err(io::ErrorKind::AlreadyExists)
    );
    let again = AtomicFile::create_new(&path);
    assert_eq!(
        again.map(drop).map_err(kind),
        Err(io::ErrorKind::AlreadyExists)
    );
    assert_eq!(fs::read(&path).unwrap(), b"theirs");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// A killed process leaves its temporary file without a lock.
#[test]
fn what_a_killed_process_left_is_removed_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let running = AtomicFile::create(place("running.csv")).unwrap();
    fs::write(place(".retarder-unfinished-aB3dE6gH"), b"half").unwrap();
    let foreign = [
        ".retarder-unfinished-",
        ".retarder-unfinished-a",
        ".retarder-unfinished-aB3-E6gH",
        ".unfinished-aB3dE6gH",
        "retarder-unfinished-aB3dE6gH",
    ];
    for name in foreign {
        fs::write(place(name), b"foreign").unwrap();
    }
    fs::create_dir(place(".retarder-unfinished-aaaaaaaa")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(place(foreign[0]), place(".retarder-unfinished-bbbbbbbb")).unwrap();
    write_file_atomically(place("log.csv"), |file| file.write_all(b"whole")).unwrap();
    assert!(!place(".retarder-unfinished-aB3dE6gH").exists());
    for name in foreign {
        assert_eq!(fs::read(place(name)).unwrap(), b"foreign", "{name}");
    }
    assert!(place(".retarder-unfinished-aaaaaaaa").is_dir());
    #[cfg(unix)]
    assert!(place(".retarder-unfinished-bbbbbbbb").is_symlink());
    running.commit().unwrap();
    assert_eq!(fs::read(place("running.csv")).unwrap(), b"");
}

#[test]
fn a_file_is_the_same_however_its_path_is_spelled() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    fs::write(place("a.csv"), b"a").unwrap();
    fs::write(place("b.csv"), b"a").unwrap();
    fs::create_dir(place("sub")).unwrap();
    let check = |one: &str, other: &str, is_same: bool| {
        let [one_is, other_is] = [one, other].map(|name| FileIdentity::of(place(name)));
        assert_eq!(one_is == other_is, is_same, "{one} and {other}");
    };
    check("a.csv", "sub/.././a.csv", true);
    check("a.csv", "b.csv", false);
    check("new.csv", "sub/../new.csv", true);
    check("new.csv", "sub/new.csv", false);
    check("absent/new.csv", "absent/new.csv", true);
    check("absent/new.csv", "new.csv", false);
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        symlink("a.csv", place("link.csv")).unwrap();
        symlink("../new.csv", place("sub/link.csv")).unwrap();
        symlink("sub", place("linked")).unwrap();
        symlink("circle", place("circle")).unwrap();
        fs::hard_link(place("a.csv"), place("second.csv")).unwrap();
        check("a.csv", "link.csv", true);
        check("a.csv", "second.csv", true);
        check("new.csv", "sub/link.csv", true);
        check("linked/new.csv", "sub/new.csv", true);
        check("circle", "a.csv", false);
    }
    let open = FileIdentity::of_open(&File::open(place("a.csv")).unwrap());
    assert!(open.is_none_or(|open| open == FileIdentity::of(place("a.csv"))));
}

/// The file appears at the target of the link, and does not replace the link.
#[cfg(unix)]
#[test]
fn a_file_appears_at_the_end_of_links_that_lead_to_none_yet() {
    let folder = tempfile::tempdir().unwrap();
    let [link, target] = ["link.csv", "target.csv"].map(|name| folder.path().join(name));
    std::os::unix::fs::symlink("target.csv", &link).unwrap();
    write_file_atomically(&link, |file| file.write_all(b"new")).unwrap();
    assert!(link.is_symlink());
    assert_eq!(fs::read(&target).unwrap(), b"new");
}
